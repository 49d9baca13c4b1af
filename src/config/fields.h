// Typed reading of a YAML tree by tables of keys. Every error is added to Errors with its place and path. A reader that
// has no valid value returns nothing and reading goes on, so that one run finds all errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
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

/// One value of a file, which may be missing, and the kinds of values that are allowed. Readers return nothing for a
/// missing value, and complain if it is required. Reading a kind that its table does not allow is a bug of ours:
/// std::logic_error.
class Field {
 public:
  /// `node` is null if the value is missing; `place` is then that of the map in which it is missing. `value` must
  /// outlive the field.
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
  /// Reads a number in a range that depends on other keys. `range` lies within that of the table.
  std::optional<double> number(const Range& range) const;
  /// Reads an integer. Returns nothing, without a complaint, if the value is a word that is allowed instead.
  std::optional<std::int64_t> integer() const;
  std::optional<bool> flag() const;
  /// Reads a text that is printable, not empty, and at most 1024 bytes long.
  std::optional<std::string> text() const;
  /// Reads one of the words of the table; null if there is none.
  const Word* word() const;
  template <class E>
  std::optional<E> choice() const {
    const Word* chosen = word();
    return chosen ? std::optional(static_cast<E>(chosen->meaning)) : std::nullopt;
  }
  std::optional<core::Vec3> vec3() const;
  /// Reads a list of as many numbers as the table demands.
  std::optional<std::vector<double>> numbers() const;

  /// Returns the values of a list; none if the value is no valid list.
  std::vector<Field> items() const;
  /// Calls visit(item) for the values of a list, which may be packed. None if the value is no valid list.
  void for_each_item(const std::function<void(const Field& item)>& visit) const;
  /// Returns the entries of a map whose keys are names, in the order of the file, without repeated names.
  std::vector<std::pair<std::string, Field>> entries() const;

  /// Adds the error "found ..., allowed: ..." (or "missing"). For a value that was removed (gone.h) the error gives its
  /// replacement.
  void refuse(std::string_view allowed) const;
  /// Adds an error with any other message.
  void complain(std::string_view message) const;

 private:
  std::string found() const;
  const Value& as(Value::Kind kind) const;
  bool is_list_of(const Value& wanted) const;
  std::vector<Field> children(const Value& each) const;

  const YamlNode* node_;
  Place place_;
  std::string path_;
  const Value* value_;
  bool required_;
  Errors* errors_;
};

/// A map whose keys are in a table. Readers ask for keys one by one; close() complains about keys that are in no table.
class Fields {
 public:
  /// Uses the keys of the field's only table, and those that it shares with others.
  explicit Fields(const Field& map);
  /// Uses the keys of one of the field's tables.
  Fields(const Field& map, const KeyTable& chosen);
  /// Uses the keys of all tables of the field. For maps that fit none of them, when errors cannot be given key by key.
  static Fields of_any_table(const Field& map);

  bool given() const { return map_.is_map(); }
  bool has(std::string_view key) const { return given() && map_.node()->find(key) != nullptr; }
  const Field& whole() const { return map_; }

  /// Returns the field of a key. Throws std::logic_error if no table has the key.
  Field operator[](std::string_view key) const;

  /// Returns the given fields among the keys of which exactly one is required (KeyTable::one_of).
  std::vector<Field> given_of(const KeyTable& table) const;

  /// Complains about unknown keys. Call it once.
  void close() const;

 private:
  Fields(const Field& map, std::vector<const KeyTable*> tables);

  std::vector<std::string_view> allowed() const;

  Field map_;
  std::vector<const KeyTable*> tables_;
};

/// Joins names as "a, b, c", cut when long.
std::string listed(const std::vector<std::string_view>& names);

/// Returns `parent.key`, or just the key at the top.
std::string path_to(std::string_view parent, std::string_view key);

}  // namespace aurasim::config
