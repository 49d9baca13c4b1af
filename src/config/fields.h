// Typed reading of a YAML tree by tables of keys. Everything that is wrong is added to Errors with its place and path;
// a reader that has nothing to give returns nothing and reading goes on, so that one run finds all errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/errors.h"
#include "config/keys.h"
#include "config/yaml_tree.h"
#include "core/body_state.h"

namespace aurasim::config {

/// One value of a file, or the lack of one, and what it may be. Readers of a value that is not there return nothing,
/// and complain if it is required. Asking for another kind than its table says is an error of ours: std::logic_error.
class Field {
 public:
  /// `node` may be null: the value is not there, and `place` is that of the map it is missing from. `value` outlives
  /// the field.
  Field(const YamlNode* node, const Place& place, std::string path, const Value& value, bool required, Errors& errors);

  bool given() const { return node_ != nullptr; }
  bool required() const { return required_; }
  bool is_map() const { return given() && node_->kind == YamlNode::Kind::kMap; }
  bool is_list() const { return given() && node_->kind == YamlNode::Kind::kList; }
  bool is_text() const { return given() && node_->kind == YamlNode::Kind::kText; }
  bool is_word(std::string_view word) const { return is_text() && node_->text == word; }
  const YamlNode* node() const { return node_; }
  const Place& place() const { return place_; }
  const std::string& path() const { return path_; }
  const Value& value() const { return *value_; }
  Errors& errors() const { return *errors_; }

  std::optional<double> number() const;
  /// For a range that depends on other keys, within that of the table.
  std::optional<double> number(const Range& range) const;
  /// Nothing, without a complaint, if it is a word that may stand there instead.
  std::optional<std::int64_t> integer() const;
  std::optional<bool> flag() const;
  /// Printable, not empty, at most 1024 bytes.
  std::optional<std::string> text() const;
  /// One of the words of the table.
  const Word* word() const;
  template <class E>
  std::optional<E> choice() const {
    const Word* chosen = word();
    return chosen ? std::optional(static_cast<E>(chosen->meaning)) : std::nullopt;
  }
  std::optional<core::Vec3> vec3() const;
  /// As many as the table says.
  std::optional<std::vector<double>> numbers() const;

  /// The values of a list; none if it is no such list.
  std::vector<Field> items() const;
  /// The entries of a map whose keys are names, in the order of the file, without second entries of a name.
  std::vector<std::pair<std::string, Field>> entries() const;

  /// "found ..., allowed: ..." (or "missing"); of a value that is gone (gone.h) what became of it.
  void refuse(std::string_view allowed) const;
  /// Any other message.
  void complain(std::string_view message) const;

 private:
  std::string found() const;
  const Value& as(Value::Kind kind) const;
  std::vector<Field> children(const Value& each) const;

  const YamlNode* node_;
  Place place_;
  std::string path_;
  const Value* value_;
  bool required_;
  Errors* errors_;
};

/// A map whose keys are in a table. Keys are asked for one by one; close() complains about those that are in no table.
class Fields {
 public:
  /// With the keys of the field's only table, and what it shares with others.
  explicit Fields(const Field& map);
  /// With the keys of one of its tables.
  Fields(const Field& map, const KeyTable& chosen);
  /// What is wrong cannot be said key by key: with the keys of all its tables.
  static Fields of_any_table(const Field& map);

  bool given() const { return map_.is_map(); }
  bool has(std::string_view key) const { return given() && map_.node()->find(key) != nullptr; }
  const Field& whole() const { return map_; }

  /// std::logic_error if no table has the key.
  Field operator[](std::string_view key) const;

  /// Those of the keys of which exactly one has to be there.
  std::vector<Field> given_of(const KeyTable& table) const;

  /// To be called once.
  void close() const;

 private:
  Fields(const Field& map, std::vector<const KeyTable*> tables);

  std::vector<std::string_view> allowed() const;

  Field map_;
  std::vector<const KeyTable*> tables_;
};

/// "a, b, c", cut when long.
std::string listed(const std::vector<std::string_view>& names);

/// `parent.key`, or just the key at the top.
std::string path_to(std::string_view parent, std::string_view key);

}  // namespace aurasim::config
