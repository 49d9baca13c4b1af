#include "cli/throw_away_keys.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "cli/key_choice.h"

namespace aurasim::cli {
namespace {

/// For its owner only, like what mkdtemp makes.
std::filesystem::path new_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "aurasim-keys-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot create it: {}", name, std::strerror(errno)));
  }
  return name;
}

}  // namespace

ThrowAwayKeys::ThrowAwayKeys(std::size_t regions) : parent_(new_folder()) {
  try {
    make_keys_for_one_host(folder(), regions);
  } catch (...) {
    std::error_code error;
    std::filesystem::remove_all(parent_, error);
    throw;
  }
}

ThrowAwayKeys::~ThrowAwayKeys() {
  std::error_code error;
  std::filesystem::remove_all(parent_, error);
}

}  // namespace aurasim::cli
