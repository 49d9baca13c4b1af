#pragma once

#include <filesystem>

namespace aurasim::cli {

/// Keys for one run on this host, in a folder that nobody else may read, until this ends.
class ThrowAwayKeys {
 public:
  explicit ThrowAwayKeys(std::size_t regions);
  ~ThrowAwayKeys();
  ThrowAwayKeys(const ThrowAwayKeys&) = delete;
  ThrowAwayKeys& operator=(const ThrowAwayKeys&) = delete;

  std::filesystem::path folder() const { return parent_ / "keys"; }

 private:
  std::filesystem::path parent_;
};

}  // namespace aurasim::cli
