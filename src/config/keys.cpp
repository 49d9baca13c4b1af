#include "config/keys.h"

#include <algorithm>

#include <fmt/format.h>

namespace aurasim::config {

std::string Range::text() const {
  if (low_excluded) return fmt::format("a number above {} and up to {}", low, high);
  return fmt::format("a number from {} to {}", low, high);
}

Value Value::or_word(std::string_view word) && {
  Value other{.kind = Kind::kWord};
  other.words.push_back({word, 0});
  return std::move(*this).or_else(std::move(other));
}

Value Value::or_else(Value other) && {
  also.push_back(std::move(other));
  return std::move(*this);
}

Value Value::with(Table more) && {
  shared.push_back(std::move(more));
  return std::move(*this);
}

const Value* Value::as(Kind wanted) const {
  if (kind == wanted) return this;
  const auto found = std::ranges::find(also, wanted, &Value::kind);
  return found == also.end() ? nullptr : &*found;
}

bool Value::has_word(std::string_view word) const {
  const Value* choice = as(Kind::kWord);
  return choice != nullptr && std::ranges::find(choice->words, word, &Word::name) != choice->words.end();
}

Value number(const Range& range, std::string_view unit) {
  return {.kind = Value::Kind::kNumber, .range = range, .unit = unit};
}

Value integer(std::int64_t low, std::int64_t high, std::string_view unit) {
  return {.kind = Value::Kind::kInteger, .lowest = low, .highest = high, .unit = unit};
}

Value flag() { return {.kind = Value::Kind::kFlag}; }

Value text(std::string_view what) { return {.kind = Value::Kind::kText, .what = what}; }

Value words(std::initializer_list<std::string_view> names) {
  Value value{.kind = Value::Kind::kWord};
  for (const std::string_view name : names) value.words.push_back({name, 0});
  return value;
}

Value name_of(std::string_view kind) { return {.kind = Value::Kind::kName, .what = kind}; }

Value numbers(std::size_t count, const Range& each, std::string_view unit) {
  return {.kind = Value::Kind::kNumbers, .range = each, .unit = unit, .fewest = count, .most = count};
}

Value vec3(std::string_view unit, const Range& each) { return numbers(3, each, unit); }

Value list(std::size_t fewest, std::size_t most, Value item) {
  return {.kind = Value::Kind::kList, .fewest = fewest, .most = most, .items = {std::move(item)}};
}

Value map(Table table) { return {.kind = Value::Kind::kMap, .tables = {std::move(table)}}; }

Value map_of_one(std::vector<Table> tables) { return {.kind = Value::Kind::kMap, .tables = std::move(tables)}; }

Value named(std::string_view what, Value entry) {
  return {.kind = Value::Kind::kNamed, .what = what, .items = {std::move(entry)}};
}

Key Key::usual(std::string yaml) && {
  default_value = std::move(yaml);
  return std::move(*this);
}

Key Key::otherwise(std::string words) && {
  default_words = std::move(words);
  return std::move(*this);
}

Key required(std::string_view name, Value value, std::string_view meaning) {
  return {.name = name, .required = true, .value = std::move(value), .meaning = meaning};
}

Key required_unless_central(std::string_view name, Value value, std::string_view meaning) {
  return {.name = name, .value = std::move(value), .meaning = meaning, .required_unless_central = true};
}

Key optional(std::string_view name, Value value, std::string_view meaning) {
  return {.name = name, .value = std::move(value), .meaning = meaning};
}

const Key* KeyTable::find(std::string_view name) const {
  const auto found = std::ranges::find(keys, name, &Key::name);
  return found == keys.end() ? nullptr : &*found;
}

bool is_required(const Key& key, std::string_view count) {
  return key.required || (key.required_unless_central && count != "1");
}

}  // namespace aurasim::config
