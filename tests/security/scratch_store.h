// A store of keys in a folder of its own, removed at the end.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <stdlib.h>

#include "security/key_store.h"

namespace aurasim::security {

class ScratchStore {
 public:
  ScratchStore() : parent_(new_folder()), store(KeyStore::create(parent_ / "keys", std::chrono::days(30))) {}
  ~ScratchStore() { std::filesystem::remove_all(parent_); }
  ScratchStore(const ScratchStore&) = delete;
  ScratchStore& operator=(const ScratchStore&) = delete;

  const std::filesystem::path& parent() const { return parent_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(parent_ / name, std::ios::binary) << text;
    return parent_ / name;
  }

 private:
  static std::filesystem::path new_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "aurasim_store_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error(name);
    return name;
  }
  std::filesystem::path parent_;

 public:
  KeyStore store;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace aurasim::security
