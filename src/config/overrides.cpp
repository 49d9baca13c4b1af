#include "config/overrides.h"

#include <charconv>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::config {
namespace {

/// Splits a path: "a.b[0].c" and "a.b.0.c" become a, b, 0, c. Empty if a name is empty.
std::vector<std::string> split_path(std::string_view text) {
  std::vector<std::string> names(1);
  for (const char c : text) {
    if (c == '.' || c == '[') {
      names.emplace_back();
    } else if (c != ']') {
      names.back() += c;
    }
  }
  for (const std::string& name : names) {
    if (name.empty()) return {};
  }
  return names;
}

std::optional<Override> parse_override(const std::string& text, Errors& errors) {
  const Place at{errors.add_source("--set " + in_quotes(text).substr(1, in_quotes(text).size() - 2)), 0, 0};
  const auto equals = text.find('=');
  Override parsed;
  if (equals != std::string::npos) parsed.path = split_path(std::string_view(text).substr(0, equals));
  if (parsed.path.empty()) {
    errors.add(at, "the override", fmt::format("found {}, allowed: key.path=value", in_quotes(text)));
    return std::nullopt;
  }
  std::optional<YamlNode> value = parse_yaml(text.substr(equals + 1), at, errors);
  if (!value) return std::nullopt;
  parsed.value = std::move(*value);
  return parsed;
}

std::optional<std::size_t> index_in(const YamlNode& list, std::string_view name) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (error != std::errc() || end != name.data() + name.size() || index >= list.size()) return std::nullopt;
  return index;
}

/// Returns the child that `name` leads to; a map gets a new one if needed. Null: there can be no such child.
YamlNode* child_of(YamlNode& parent, const std::string& name, const Place& at) {
  if (parent.kind == YamlNode::Kind::kList) {
    const auto index = index_in(parent, name);
    return index ? &parent.entry(*index) : nullptr;
  }
  if (parent.kind != YamlNode::Kind::kMap) return nullptr;
  if (YamlNode* child = parent.find(name)) return child;
  YamlNode child;
  child.kind = YamlNode::Kind::kMap;
  child.key = name;
  child.place = child.key_place = at;
  parent.children.push_back(std::move(child));
  return &parent.children.back();
}

std::string way_on(const YamlNode& parent) {
  switch (parent.kind) {
    case YamlNode::Kind::kList:
      return parent.size() == 0 ? "nothing, the list is empty"
                                : fmt::format("an index from 0 to {}", parent.size() - 1);
    case YamlNode::Kind::kText:
      return fmt::format("nothing below the value {}", in_quotes(parent.text));
    default:
      return "nothing below a value that is empty";
  }
}

}  // namespace

std::vector<Override> parse_overrides(const std::vector<std::string>& texts, Errors& errors) {
  std::vector<Override> overrides;
  for (const std::string& text : texts) {
    if (auto parsed = parse_override(text, errors)) overrides.push_back(std::move(*parsed));
  }
  return overrides;
}

void apply_override(const Override& change, YamlNode& root, Errors& errors) {
  YamlNode* node = &root;
  for (const std::string& name : change.path) {
    YamlNode* next = child_of(*node, name, change.value.place);
    if (next == nullptr) {
      errors.add(change.value.place, fmt::format("{}", fmt::join(change.path, ".")),
                 fmt::format("found {}, allowed: {}", in_quotes(name), way_on(*node)));
      return;
    }
    node = next;
  }
  std::string key = std::move(node->key);
  *node = change.value;
  node->key = std::move(key);
  node->key_place = change.value.place;
}

}  // namespace aurasim::config
