#include "config/fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "config/utf8.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kLongestText = 1024;
constexpr std::size_t kMostNamesListed = 20;

/// The whole text as a number; nothing for "1 m", "nan", "1e999", "" or anything in quotes.
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

std::string Range::text() const {
  if (low_excluded) return fmt::format("a number above {} and up to {}", low, high);
  return fmt::format("a number from {} to {}", low, high);
}

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

Field::Field(const YamlNode* node, const Place& place, std::string path, bool required, Errors& errors)
    : node_(node), place_(node ? node->place : place), path_(std::move(path)), required_(required), errors_(&errors) {}

std::string Field::found() const {
  switch (node_->kind) {
    case YamlNode::Kind::kNothing:
      return "nothing";
    case YamlNode::Kind::kText:
      return in_quotes(node_->text);
    case YamlNode::Kind::kList:
      return fmt::format("a list of {}", node_->children.size());
    case YamlNode::Kind::kMap:
      return fmt::format("a map of {}", node_->children.size());
  }
  return "nothing";
}

void Field::refuse(std::string_view allowed) const {
  if (given()) {
    errors_->add(place_, path_, fmt::format("found {}, allowed: {}", found(), allowed));
  } else if (required_) {
    errors_->add(place_, path_, fmt::format("missing, allowed: {}", allowed));
  }
}

void Field::complain(std::string_view message) const { errors_->add(place_, path_, message); }

std::optional<double> Field::number(const Range& range) const {
  const std::optional<double> value = given() ? parsed<double>(*node_) : std::nullopt;
  if (value && std::isfinite(*value) && range.contains(*value)) return *value + 0.0;  // no negative zero
  refuse(range.text());
  return std::nullopt;
}

std::optional<std::int64_t> Field::integer(std::int64_t low, std::int64_t high, std::string_view also_allowed) const {
  const std::optional<std::int64_t> value = given() ? parsed<std::int64_t>(*node_) : std::nullopt;
  if (value && *value >= low && *value <= high) return value;
  refuse(fmt::format("{}an integer from {} to {}", also_allowed, low, high));
  return std::nullopt;
}

std::optional<bool> Field::flag() const {
  if (is_text() && !node_->quoted && (node_->text == "true" || node_->text == "false")) return node_->text == "true";
  refuse("true, false");
  return std::nullopt;
}

std::optional<std::string> Field::text(std::string_view allowed) const {
  if (is_text() && !node_->text.empty() && node_->text.size() <= kLongestText && is_printable_line(node_->text)) {
    return node_->text;
  }
  refuse(allowed);
  return std::nullopt;
}

std::optional<std::vector<double>> Field::numbers(std::size_t count, const Range& each) const {
  if (!is_list() || node_->children.size() != count) {
    refuse(fmt::format("a list of {}, each {}", count, each.text()));
    return std::nullopt;
  }
  std::vector<double> values;
  for (const Field& item : items(count, count)) {
    if (const auto value = item.number(each)) values.push_back(*value);
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

std::optional<core::Vec3> Field::vec3(const Range& each) const {
  const auto values = numbers(3, each);
  if (!values) return std::nullopt;
  return core::Vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::vector<Field> Field::items(std::size_t fewest, std::size_t most) const {
  if (!is_list() || node_->children.size() < fewest || node_->children.size() > most) {
    refuse(fmt::format("a list of {} to {}", fewest, most));
    return {};
  }
  std::vector<Field> fields;
  fields.reserve(node_->children.size());
  for (std::size_t i = 0; i < node_->children.size(); ++i) {
    fields.emplace_back(&node_->children[i], place_, fmt::format("{}[{}]", path_, i), true, *errors_);
  }
  return fields;
}

std::vector<std::pair<std::string, Field>> Field::entries(std::string_view allowed) const {
  if (!is_map()) {
    refuse(allowed);
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
    fields.emplace_back(entry.key, Field(&entry, place_, path, true, *errors_));
  }
  return fields;
}

Fields::Fields(const Field& map) : map_(map) {
  if (given()) report_copies(*map.node(), map.path(), map.errors());
}

Field Fields::ask(std::string_view key, bool required) {
  asked_.push_back(key);
  const YamlNode* node = given() ? map_.node()->find(key) : nullptr;
  // What is missing from a map that is itself missing or wrong has been said already.
  return Field(node, map_.place(), path_to(map_.path(), key), required && given(), map_.errors());
}

void Fields::close() const {
  if (!given()) {
    map_.refuse(fmt::format("a map of {}", listed(asked_)));
    return;
  }
  for (const YamlNode& entry : map_.node()->children) {
    if (std::find(asked_.begin(), asked_.end(), entry.key) != asked_.end()) continue;
    map_.errors().add(entry.key_place, path_to(map_.path(), entry.key),
                      fmt::format("unknown key, allowed: {}", listed(asked_)));
  }
}

}  // namespace aurasim::config
