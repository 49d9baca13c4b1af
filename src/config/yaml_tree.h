// A YAML file as a tree of values that know where they were written. Reads untrusted bytes: size, number of
// values, encoding and aliases are limited, and everything that is wrong is reported, never thrown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/errors.h"

namespace aurasim::config {

class PackedNodes;

struct YamlNode {
  enum class Kind : std::uint8_t { kNothing, kText, kList, kMap };

  Kind kind = Kind::kNothing;
  bool quoted = false;  ///< written in quotes or with a tag: text even if it looks like a number
  Place place;
  Place key_place;  ///< place of its key, when it is in a map
  std::string key;
  std::string text;
  std::vector<YamlNode> children;  ///< entries of a list, or of a map in the order of the file, repeated keys included
  /// Entries of a long list, instead of `children`. Copies of the node share them.
  std::shared_ptr<PackedNodes> packed;

  /// Number of entries of a list or map.
  std::size_t size() const;
  /// An entry of a list, to be changed. Precondition: index < size().
  YamlNode& entry(std::size_t index);
  const YamlNode* find(std::string_view wanted_key) const;
  YamlNode* find(std::string_view wanted_key);
};

/// Largest file that is read.
inline constexpr std::uintmax_t kLargestFileBytes = 16u << 20;
/// Most values that one file may have once its aliases are expanded.
inline constexpr std::size_t kMostYamlNodes = 1'000'000;

/// Returns the text of a readable regular file of at most `limit` bytes; otherwise nothing, and the reason in `why`.
std::optional<std::string> read_bytes(const std::filesystem::path& file, std::uintmax_t limit, std::string& why);

/// True for a readable regular file of at most `limit` bytes; otherwise the reason is in `why`.
bool can_be_read(const std::filesystem::path& file, std::uintmax_t limit, std::string& why);

/// Parses one YAML document. `at` is where its text begins: (source, 1, 1) for a file, (source, 0, 0) for an override.
std::optional<YamlNode> parse_yaml(const std::string& text, const Place& at, Errors& errors);

/// Reads the document in a file, which becomes a source of `errors`. `long_lists`: keys of the document's map. If they
/// hold lists, these are packed. The text of the file is not held as a whole.
std::optional<YamlNode> read_yaml(const std::filesystem::path& file, Errors& errors,
                                  std::span<const std::string_view> long_lists = {});

}  // namespace aurasim::config
