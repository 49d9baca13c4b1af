// The entries of a long list of a YAML file, packed: some 50 bytes for an entry whose YamlNodes take 1,000.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "config/yaml_tree.h"

namespace aurasim::config {

class PackedNodes {
 public:
  /// `source`: that of all places in the entries.
  explicit PackedNodes(std::uint32_t source) : source_(source) {}

  void add(const YamlNode& entry);
  std::size_t size() const { return size_; }
  /// Number of values in all entries as they were added.
  std::size_t count() const { return count_; }

  /// Calls visit(entry) for all entries, in order. Makes one at a time.
  template <class Visit>
  void for_each(Visit&& visit) const;
  /// An entry that stays unpacked, so that it can be changed. Precondition: index < size().
  YamlNode& unpacked(std::size_t index);

 private:
  static constexpr std::size_t kOfChunk = 64;

  /// Reads the nodes of a chunk.
  struct Cursor {
    std::string_view rest;
    std::uint64_t number();
    std::string_view text(std::size_t length);
  };

  std::uint64_t number_of(const std::string& key);
  void put(const YamlNode& node, int& line);
  YamlNode get(Cursor& from, int& line) const;

  std::uint32_t source_;
  std::size_t size_ = 0, count_ = 0;
  int last_line_ = 0;                ///< of the newest place
  std::vector<std::string> chunks_;  ///< kOfChunk entries each
  std::vector<std::string> keys_;
  std::unordered_map<std::string, std::uint64_t> key_numbers_;
  std::map<std::size_t, YamlNode> unpacked_;
};

template <class Visit>
void PackedNodes::for_each(Visit&& visit) const {
  Cursor cursor;
  int line = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    if (i % kOfChunk == 0) cursor = {chunks_[i / kOfChunk]}, line = 0;
    const YamlNode entry = get(cursor, line);
    const auto changed = unpacked_.find(i);
    visit(changed == unpacked_.end() ? entry : changed->second);
  }
}

}  // namespace aurasim::config
