// DDS domains for tests, given out in one place: no two tests that run at the same time on this machine can get the
// same one, whichever program, process or checkout they belong to.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aurasim::test {

/// A domain that is nobody else's as long as this object lives. Who holds it has locked a file of its number; the
/// kernel lets go of it when the process dies.
class LeasedDomain {
 public:
  LeasedDomain() {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "aurasim_test_domains";
    ::mkdir(folder.c_str(), 0777);
    ::chmod(folder.c_str(), 01777);
    for (std::uint32_t tries = 0; tries < kCount; ++tries) {
      number_ = kFirst + next() % kCount;
      file_ = ::open((folder / std::to_string(number_)).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
      if (file_ >= 0) ::close(file_);
    }
    throw std::runtime_error("no DDS domain is free: see " + folder.string());
  }
  ~LeasedDomain() { ::close(file_); }
  LeasedDomain(const LeasedDomain&) = delete;
  LeasedDomain& operator=(const LeasedDomain&) = delete;

  std::uint32_t number() const { return number_; }

 private:
  // Beyond 101 the ports of a domain are those that Linux gives to whoever asks for any.
  static constexpr std::uint32_t kFirst = 2, kCount = 100;

  /// Not the one that was let go of last: a process that was killed may still be remembered there.
  static std::uint32_t next() {
    static std::uint32_t cursor = 31U * static_cast<std::uint32_t>(::getpid());
    return cursor++;
  }

  std::uint32_t number_ = 0;
  int file_ = -1;
};

/// The domain of the test that is running; with `which` 1 a second one, for two runs side by side.
inline std::uint32_t own_domain(std::size_t which = 0) {
  static const ::testing::TestInfo* test = nullptr;
  static std::array<std::optional<LeasedDomain>, 2> domains;
  const ::testing::TestInfo* const running = ::testing::UnitTest::GetInstance()->current_test_info();
  if (running != test) {
    for (auto& domain : domains) domain.reset();
    test = running;
  }
  if (!domains.at(which)) domains[which].emplace();
  return domains[which]->number();
}

}  // namespace aurasim::test
