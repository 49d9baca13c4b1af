// A store of keys in a folder of its own, removed at the end.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <stdlib.h>

#include "scratch_folder.h"
#include "security/key_store.h"

namespace aurasim::security {

class ScratchStore {
 public:
  const std::filesystem::path& parent() const { return folder_.path(); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    return folder_.write(name, text);
  }

 private:
  test::ScratchFolder folder_;

 public:
  KeyStore store = KeyStore::create(folder_.path() / "keys", std::chrono::days(30));
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace aurasim::security
