#include "cut/cut_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), what));
}

/// Writes a file and waits until it is on the disk.
void write_through(const fs::path& file, const std::string& bytes) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) fail(file, std::strerror(errno));
  std::size_t done = 0;
  int error = 0;
  while (done < bytes.size() && error == 0) {
    const ssize_t written = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (written > 0) done += static_cast<std::size_t>(written);
    if (written < 0 && errno != EINTR) error = errno;
  }
  if (error == 0 && ::fsync(fd) != 0) error = errno;
  ::close(fd);
  if (error == 0) return;
  std::error_code ignored;
  fs::remove(file, ignored);
  fail(file, std::strerror(error));
}

/// Waits until the names of files in a folder are on the disk.
void sync_folder(const fs::path& folder) {
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);  // the result is ignored: some file systems cannot do it
  ::close(fd);
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw BadCut(fmt::format("{}: cannot be read", file.string()));
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Are both identities of one world, computed by one program?
bool same(const Identity& a, const Identity& b) { return a.world == b.world && a.program == b.program; }

std::string words(const Identity& identity) {
  return fmt::format("{} (scene {}; {})", identity.launch, identity.scene, identity.physics);
}

}  // namespace

void write_cut(const fs::path& file, const SavedWorld& world) {
  const fs::path beside(file.string() + ".new");
  write_through(beside, encode(world));
  std::error_code error;
  fs::rename(beside, file, error);
  if (!error) return sync_folder(file.parent_path());
  std::error_code ignored;
  fs::remove(beside, ignored);
  fail(file, error.message());
}

SavedWorld read_cut(const fs::path& file) {
  try {
    return decode(text_of(file));
  } catch (const BadCut& bad) {
    throw BadCut(fmt::format("{}: {}", file.string(), bad.what()));
  }
}

SavedWorld read_header(const fs::path& file) {
  try {
    return decode_header(text_of(file));
  } catch (const BadCut& bad) {
    throw BadCut(fmt::format("{}: {}", file.string(), bad.what()));
  }
}

SavedWorld merge_cuts(const std::vector<fs::path>& files) {
  if (files.empty()) throw BadCut("there are no parts");
  SavedWorld whole;
  std::vector<core::WorldCut> cuts;
  std::set<std::uint32_t> parts;
  for (const fs::path& file : files) {
    SavedWorld part = read_cut(file);
    const bool is_first = parts.empty();
    if (!is_first && (part.parts != whole.parts || !same(part.identity, whole.identity))) {
      throw BadCut(fmt::format("{} and {} are not of one world", files.front().string(), file.string()));
    }
    if (!is_first && (part.save != whole.save || part.cut.step != whole.cut.step)) {
      throw BadCut(fmt::format("{} (state {}) and {} (state {}) were not saved together", files.front().string(),
                               whole.cut.step, file.string(), part.cut.step));
    }
    if (!parts.insert(part.part).second) {
      throw BadCut(fmt::format("{}: part {} is there twice", file.string(), part.part));
    }
    cuts.push_back(std::move(part.cut));
    if (is_first) {
      whole = std::move(part);
    } else {
      whole.saved_ms = std::max(whole.saved_ms, part.saved_ms);
    }
  }
  if (parts.size() != whole.parts) {
    std::uint32_t missing = 0;
    while (parts.contains(missing)) ++missing;
    throw BadCut(fmt::format("{}: {} of {} parts are there; part {} is missing", files.front().string(), parts.size(),
                             whole.parts, missing));
  }
  try {
    whole.cut = core::merge(std::move(cuts));
  } catch (const std::invalid_argument& error) {
    throw BadCut(fmt::format("{}: {}", files.front().string(), error.what()));
  }
  whole.part = 0;
  whole.parts = 1;
  return whole;
}

std::string check_identity(const fs::path& file, const Identity& found, const Identity& wanted, bool other_program) {
  const auto refuse = [&](const std::string& why) { throw BadCut(fmt::format("{}: {}", file.string(), why)); };
  if (found.world != wanted.world) {
    refuse(
        fmt::format("the world of {}, and this is {}: it fits the launch and scene files, with the overrides, that it "
                    "was saved with",
                    words(found), words(wanted)));
  }
  if (found.program == wanted.program) return {};
  const std::string differs = fmt::format("saved by {}, and this is {}", found.program, wanted.program);
  if (!other_program) refuse(differs + ": --other-build loads it all the same, but bits may differ");
  return differs;
}

}  // namespace aurasim::cut
