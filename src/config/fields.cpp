#include "config/fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <unordered_map>

#include <fmt/format.h>

#include "config/gone.h"
#include "config/packed_nodes.h"
#include "config/utf8.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kLongestText = 1024;
constexpr std::size_t kMostNamesListed = 20;

/// Parses the whole text as a number; nothing for "1 m", "nan", "1e999", "" or anything in quotes.
template <class Number>
std::optional<Number> parsed(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kText || node.quoted) return std::nullopt;
  std::string_view text = node.text;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_printable_line(std::string_view text) {
  return first_unprintable(text) == text.size() && text.find_first_of("\n\r\t") == std::string_view::npos;
}

void report_copies(const YamlNode& map, const std::string& path, Errors& errors) {
  std::unordered_map<std::string_view, int> first_line;
  for (const YamlNode& entry : map.children) {
    const auto [seen, is_new] = first_line.try_emplace(entry.key, entry.key_place.line);
    if (is_new) continue;
    errors.add(entry.key_place, path_to(path, entry.key),
               fmt::format("found a second time, first at line {}, allowed: once", seen->second));
  }
}

}  // namespace

std::string path_to(std::string_view parent, std::string_view key) {
  const std::string shown = is_printable_line(key) ? std::string(key.substr(0, 80)) : in_quotes(key);
  return parent.empty() ? shown : fmt::format("{}.{}", parent, shown);
}

std::string listed(const std::vector<std::string_view>& names) {
  if (names.empty()) return "nothing";
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamesListed); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", names[i]);
  }
  if (names.size() > kMostNamesListed) text += fmt::format(" or {} others", names.size() - kMostNamesListed);
  return text;
}

Field::Field(const YamlNode* node, const Place& place, std::string path, const Value& value, bool required,
             Errors& errors)
    : node_(node),
      place_(node ? node->place : place),
      path_(std::move(path)),
      value_(&value),
      required_(required),
      errors_(&errors) {}

const Value& Field::as(Value::Kind kind) const {
  if (const Value* value = value_->as(kind)) return *value;
  throw std::logic_error("the table of keys says otherwise of " + path_);
}

std::string Field::found() const {
  switch (node_->kind) {
    case YamlNode::Kind::kNothing:
      return "nothing";
    case YamlNode::Kind::kText:
      return in_quotes(node_->text);
    case YamlNode::Kind::kList:
      return fmt::format("a list of {}", node_->size());
    case YamlNode::Kind::kMap:
      return fmt::format("a map of {}", node_->children.size());
  }
  return "nothing";
}

void Field::refuse(std::string_view allowed) const {
  if (const Gone* gone = is_text() ? gone_value(path_, node_->text) : nullptr) {
    errors_->add(place_, path_, fmt::format("found {}, which is gone: {}", found(), gone->text));
  } else if (given()) {
    errors_->add(place_, path_, fmt::format("found {}, allowed: {}", found(), allowed));
  } else if (required_) {
    errors_->add(place_, path_, fmt::format("missing, allowed: {}", allowed));
  }
}

void Field::complain(std::string_view message) const { errors_->add(place_, path_, message); }

std::optional<double> Field::number() const {
  const Range& range = as(Value::Kind::kNumber).range;
  if (is_text() && value_->has_word(node_->text)) return std::nullopt;
  return number(range);
}

std::optional<double> Field::number(const Range& range) const {
  const std::optional<double> value = given() ? parsed<double>(*node_) : std::nullopt;
  if (value && std::isfinite(*value) && range.contains(*value)) return *value + 0.0;  // turns negative zero into zero
  refuse(range.text());
  return std::nullopt;
}

std::optional<std::int64_t> Field::integer() const {
  const Value& wanted = as(Value::Kind::kInteger);
  if (is_text() && value_->has_word(node_->text)) return std::nullopt;
  const std::optional<std::int64_t> value = given() ? parsed<std::int64_t>(*node_) : std::nullopt;
  if (value && *value >= wanted.lowest && *value <= wanted.highest) return value;
  const Value* other = value_->as(Value::Kind::kWord);
  refuse(fmt::format("{}an integer from {} to {}", other ? fmt::format("{}, or ", other->words[0].name) : "",
                     wanted.lowest, wanted.highest));
  return std::nullopt;
}

std::optional<bool> Field::flag() const {
  as(Value::Kind::kFlag);
  if (is_text() && !node_->quoted && (node_->text == "true" || node_->text == "false")) return node_->text == "true";
  if (is_text() && value_->has_word(node_->text)) return std::nullopt;
  const Value* other = value_->as(Value::Kind::kWord);
  refuse(other ? fmt::format("{}, true, false", other->words[0].name) : "true, false");
  return std::nullopt;
}

std::optional<std::string> Field::text() const {
  if (is_text() && !node_->text.empty() && node_->text.size() <= kLongestText && is_printable_line(node_->text)) {
    return node_->text;
  }
  refuse(as(Value::Kind::kText).what);
  return std::nullopt;
}

const Word* Field::word() const {
  std::vector<std::string_view> names;
  for (const Word& word : as(Value::Kind::kWord).words) {
    if (is_word(word.name)) return &word;
    names.push_back(word.name);
  }
  refuse(listed(names));
  return nullptr;
}

std::optional<std::vector<double>> Field::numbers() const {
  const Value& wanted = as(Value::Kind::kNumbers);
  if (!is_list() || node_->children.size() != wanted.most) {
    refuse(fmt::format("a list of {}, each {}", wanted.most, wanted.range.text()));
    return std::nullopt;
  }
  std::vector<double> values;
  for (const Field& item : children(wanted)) {
    if (const auto value = item.number(wanted.range)) values.push_back(*value);
  }
  if (values.size() != wanted.most) return std::nullopt;
  return values;
}

std::optional<core::Vec3> Field::vec3() const {
  const auto values = numbers();
  if (!values) return std::nullopt;
  return core::Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::vector<Field> Field::children(const Value& each) const {
  std::vector<Field> fields;
  fields.reserve(node_->children.size());
  for (std::size_t i = 0; i < node_->children.size(); ++i) {
    fields.emplace_back(&node_->children[i], place_, fmt::format("{}[{}]", path_, i), each, true, *errors_);
  }
  return fields;
}

std::vector<Field> Field::items() const {
  const Value& wanted = as(Value::Kind::kList);
  if (!is_list_of(wanted)) return {};
  if (node_->packed) throw std::logic_error("the list is packed: " + path_);
  return children(wanted.items.front());
}

void Field::for_each_item(const std::function<void(const Field& item)>& visit) const {
  const Value& wanted = as(Value::Kind::kList);
  if (!is_list_of(wanted)) return;
  std::size_t index = 0;
  const auto visit_node = [&](const YamlNode& node) {
    visit(Field(&node, place_, fmt::format("{}[{}]", path_, index++), wanted.items.front(), true, *errors_));
  };
  if (node_->packed) {
    node_->packed->for_each(visit_node);
  } else {
    std::ranges::for_each(node_->children, visit_node);
  }
}

bool Field::is_list_of(const Value& wanted) const {
  if (is_list() && node_->size() >= wanted.fewest && node_->size() <= wanted.most) return true;
  refuse(fmt::format("a list of {} to {}", wanted.fewest, wanted.most));
  return false;
}

std::vector<std::pair<std::string, Field>> Field::entries() const {
  const Value& wanted = as(Value::Kind::kNamed);
  if (!is_map()) {
    refuse(wanted.what);
    return {};
  }
  report_copies(*node_, path_, *errors_);
  std::vector<std::pair<std::string, Field>> fields;
  std::unordered_map<std::string_view, bool> seen;
  for (const YamlNode& entry : node_->children) {
    if (!seen.try_emplace(entry.key, true).second) continue;
    const std::string path = path_to(path_, entry.key);
    if (entry.key.empty() || entry.key.size() > kLongestText || !is_printable_line(entry.key)) {
      errors_->add(entry.key_place, path,
                   fmt::format("found the name {}, allowed: a printable name", in_quotes(entry.key)));
    }
    fields.emplace_back(entry.key, Field(&entry, place_, path, wanted.items.front(), true, *errors_));
  }
  return fields;
}

Fields::Fields(const Field& map, std::vector<const KeyTable*> tables) : map_(map), tables_(std::move(tables)) {
  for (const Table& table : map.value().as(Value::Kind::kMap)->shared) tables_.push_back(&table());
}

Fields::Fields(const Field& map) : Fields(map, {&map.value().as(Value::Kind::kMap)->tables.front()()}) {}

Fields::Fields(const Field& map, const KeyTable& chosen) : Fields(map, std::vector{&chosen}) {}

Fields Fields::of_any_table(const Field& map) {
  std::vector<const KeyTable*> tables;
  for (const Table& table : map.value().as(Value::Kind::kMap)->tables) tables.push_back(&table());
  return Fields(map, std::move(tables));
}

Field Fields::operator[](std::string_view name) const {
  const YamlNode* node = given() ? map_.node()->find(name) : nullptr;
  const YamlNode* count = given() ? map_.node()->find("count") : nullptr;
  for (const KeyTable* table : tables_) {
    const Key* key = table->find(name);
    if (key == nullptr) continue;
    // Keys of a map that is itself missing or wrong are not reported as missing, because the map was reported already.
    const bool required = given() && is_required(*key, count ? count->text : "");
    return Field(node, map_.place(), path_to(map_.path(), name), key->value, required, map_.errors());
  }
  throw std::logic_error(fmt::format("no table has the key {}", path_to(map_.path(), name)));
}

std::vector<Field> Fields::given_of(const KeyTable& table) const {
  std::vector<Field> fields;
  for (const std::string_view key : table.one_of) {
    if (has(key)) fields.push_back((*this)[key]);
  }
  return fields;
}

std::vector<std::string_view> Fields::allowed() const {
  std::vector<std::string_view> names;
  for (const KeyTable* table : tables_) {
    for (const Key& key : table->keys) {
      if (std::ranges::find(names, key.name) == names.end()) names.push_back(key.name);
    }
  }
  return names;
}

void Fields::close() const {
  const std::vector<std::string_view> names = allowed();
  if (!given()) {
    map_.refuse(fmt::format("a map of {}", listed(names)));
    return;
  }
  report_copies(*map_.node(), map_.path(), map_.errors());
  for (const YamlNode& entry : map_.node()->children) {
    if (std::ranges::find(names, entry.key) != names.end()) continue;
    const std::string path = path_to(map_.path(), entry.key);
    const Gone* gone = gone_key(path);
    map_.errors().add(entry.key_place, path,
                      gone ? fmt::format("this key is gone: {}", gone->text)
                           : fmt::format("unknown key, allowed: {}", listed(names)));
  }
}

}  // namespace aurasim::config
