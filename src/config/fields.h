// Typed reading of a YAML tree. Everything that is wrong is added to Errors with its place and path; a reader that
// has nothing to give returns nothing and reading goes on, so that one run finds all errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/errors.h"
#include "config/yaml_tree.h"
#include "core/body_state.h"

namespace aurasim::config {

/// The numbers that a field may have. All are finite.
struct Range {
  double low = 0;
  double high = 0;
  bool low_excluded = false;

  static constexpr Range from_to(double low, double high) { return {low, high, false}; }
  static constexpr Range above(double low, double high) { return {low, high, true}; }

  bool contains(double value) const { return (low_excluded ? value > low : value >= low) && value <= high; }
  std::string text() const;
};

/// Any coordinate or component, in the unit of the field: far beyond use, far from overflow.
inline constexpr Range kAnyNumber = Range::from_to(-1e7, 1e7);
/// A length that must not vanish.
inline constexpr Range kSize = Range::above(0, 1e6);

/// One value of a file, or the lack of one. Readers of a value that is not there return nothing, and complain
/// if it is required.
class Field {
 public:
  /// `node` may be null: the value is not there, and `place` is that of the map it is missing from.
  Field(const YamlNode* node, const Place& place, std::string path, bool required, Errors& errors);

  bool given() const { return node_ != nullptr; }
  bool is_map() const { return given() && node_->kind == YamlNode::Kind::kMap; }
  bool is_list() const { return given() && node_->kind == YamlNode::Kind::kList; }
  bool is_text() const { return given() && node_->kind == YamlNode::Kind::kText; }
  bool is_word(std::string_view word) const { return is_text() && node_->text == word; }
  const YamlNode* node() const { return node_; }
  const Place& place() const { return place_; }
  const std::string& path() const { return path_; }
  Errors& errors() const { return *errors_; }

  std::optional<double> number(const Range& range) const;
  /// `also_allowed`: what the message says before "an integer from ...".
  std::optional<std::int64_t> integer(std::int64_t low, std::int64_t high, std::string_view also_allowed = "") const;
  std::optional<bool> flag() const;
  /// Printable, not empty, at most 1024 bytes.
  std::optional<std::string> text(std::string_view allowed = "text") const;
  std::optional<core::Vec3> vec3(const Range& each = kAnyNumber) const;
  /// A list of `count` numbers.
  std::optional<std::vector<double>> numbers(std::size_t count, const Range& each) const;

  template <class E>
  std::optional<E> choice(std::initializer_list<std::pair<std::string_view, E>> choices) const;

  /// The values of a list of `fewest` to `most`; none if it is no such list.
  std::vector<Field> items(std::size_t fewest, std::size_t most) const;
  /// The entries of a map whose keys are names, in the order of the file, without second entries of a name.
  std::vector<std::pair<std::string, Field>> entries(std::string_view allowed) const;

  /// "found ..., allowed: ..." (or "missing").
  void refuse(std::string_view allowed) const;
  /// Any other message.
  void complain(std::string_view message) const;

 private:
  std::string found() const;

  const YamlNode* node_;
  Place place_;
  std::string path_;
  bool required_;
  Errors* errors_;
};

/// A map whose keys are known beforehand. Keys are asked for one by one; close() complains about all others.
class Fields {
 public:
  explicit Fields(const Field& map);

  bool given() const { return map_.is_map(); }
  bool has(std::string_view key) const { return given() && map_.node()->find(key) != nullptr; }
  const Field& whole() const { return map_; }

  Field required(std::string_view key) { return ask(key, true); }
  Field optional(std::string_view key) { return ask(key, false); }

  /// To be called once, after the last question.
  void close() const;

 private:
  Field ask(std::string_view key, bool required);

  Field map_;
  std::vector<std::string_view> asked_;
};

/// "a, b, c", cut when long.
std::string listed(const std::vector<std::string_view>& names);

/// `parent.key`, or just the key at the top.
std::string path_to(std::string_view parent, std::string_view key);

template <class E>
std::optional<E> Field::choice(std::initializer_list<std::pair<std::string_view, E>> choices) const {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : choices) {
    if (is_word(name)) return value;
    names.push_back(name);
  }
  refuse(listed(names));
  return std::nullopt;
}

}  // namespace aurasim::config
