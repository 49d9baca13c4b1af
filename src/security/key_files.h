#pragma once

#include <filesystem>

namespace aurasim::security {

/// The files that a process joins a run with (key_store.h).
struct KeyFiles {
  std::filesystem::path identity_ca;
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::filesystem::path revocations;
  std::filesystem::path permissions_ca;
  std::filesystem::path governance;
  std::filesystem::path permissions;
};

}  // namespace aurasim::security
