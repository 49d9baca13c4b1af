#include "config/key_page.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

namespace aurasim::config {
namespace {

void add_tables_of(const Value& value, std::vector<const KeyTable*>& found);

void add_with_what_follows(const KeyTable& table, std::vector<const KeyTable*>& found) {
  if (std::ranges::find(found, &table) != found.end()) return;
  found.push_back(&table);
  for (const Key& key : table.keys) add_tables_of(key.value, found);
}

void add_tables_of(const Value& value, std::vector<const KeyTable*>& found) {
  for (const Table& table : value.shared) add_with_what_follows(table(), found);
  for (const Table& table : value.tables) add_with_what_follows(table(), found);
  for (const Value& item : value.items) add_tables_of(item, found);
  for (const Value& other : value.also) add_tables_of(other, found);
}

/// Writes a number shortly: 1e7 for 10000000.
std::string short_number(double value) {
  const double size = std::abs(value);
  if (size >= 1e5 && std::log10(size) == std::floor(std::log10(size))) {
    return fmt::format("{}1e{}", value < 0 ? "-" : "", std::log10(size));
  }
  return fmt::format("{}", value);
}

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : fmt::format("{} {}", text, unit);
}

std::string range_text(const Value& value) {
  const Range& range = value.range;
  return with_unit(
      fmt::format("{}{} to {}", range.low_excluded ? "above " : "", short_number(range.low), short_number(range.high)),
      value.unit);
}

std::string count_text(const Value& list) {
  if (list.fewest == list.most) return fmt::format("list of {}", list.most);
  return fmt::format("list of {} to {}", list.fewest, list.most);
}

/// How a word, and a link to a map's section, are shown.
struct Style {
  std::string (*word)(std::string_view);
  std::string (*section)(std::string_view);
};

std::string text_of(const Value& value, const Style& style);

std::string sections_text(const Value& map, const Style& style) {
  std::string text;
  for (const Table& table : map.tables) text += (text.empty() ? "" : " or ") + style.section(table().title);
  for (const Table& table : map.shared) text += " with " + style.section(table().title);
  return text;
}

std::string words_text(const std::vector<Word>& words, const Style& style) {
  std::string text;
  for (const Word& word : words) text += (text.empty() ? "" : ", ") + style.word(word.name);
  return text;
}

std::string own_text(const Value& value, const Style& style) {
  switch (value.kind) {
    case Value::Kind::kNumber:
      return "number, " + range_text(value);
    case Value::Kind::kInteger:
      if (value.lowest == value.highest) return fmt::format("{}", value.lowest);
      return with_unit(fmt::format("integer, {} to {}", value.lowest, value.highest), value.unit);
    case Value::Kind::kFlag:
      return style.word("true") + ", " + style.word("false");
    case Value::Kind::kText:
      return std::string(value.what);
    case Value::Kind::kWord:
      return words_text(value.words, style);
    case Value::Kind::kName:
      return fmt::format("name of a {}", value.what);
    case Value::Kind::kNumbers:
      return fmt::format("{} numbers, {}", value.most, range_text(value));
    case Value::Kind::kList:
      return fmt::format("{}: {}", count_text(value), text_of(value.items.front(), style));
    case Value::Kind::kMap:
      return sections_text(value, style);
    case Value::Kind::kNamed:
      return "by names that you choose: " + text_of(value.items.front(), style);
  }
  return "";
}

std::string text_of(const Value& value, const Style& style) {
  std::string text = own_text(value, style);
  for (const Value& other : value.also) text += "; or " + own_text(other, style);
  return text;
}

bool is_one_of(const KeyTable& table, const Key& key) {
  return std::ranges::find(table.one_of, key.name) != table.one_of.end();
}

std::string default_text(const KeyTable& table, const Key& key, const Style& style) {
  if (key.required) return "required";
  if (key.required_unless_central) return "required, but not with " + style.word("count: 1");
  if (!key.default_words.empty()) return key.default_words;
  if (!key.default_value.empty()) return style.word(key.default_value);
  return is_one_of(table, key) ? "one of these" : "";
}

std::string as_code(std::string_view text) { return fmt::format("`{}`", text); }

/// Anchor of a heading, as GitHub makes it.
std::string anchor(std::string_view title) {
  std::string text;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_') {
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (c == ' ') {
      text += '-';
    }
  }
  return text;
}

std::string as_link(std::string_view title) { return fmt::format("[{}](#{})", title, anchor(title)); }

std::string section_as_markdown(const KeyTable& table) {
  const Style style{as_code, as_link};
  std::string text = fmt::format("### {}\n\n{}\n", table.title, table.about);
  if (table.keys.empty()) return text + "\n";
  text += "\n| key | value | default | meaning |\n|---|---|---|---|\n";
  for (const Key& key : table.keys) {
    text += fmt::format("| `{}` | {} | {} | {} |\n", key.name, text_of(key.value, style),
                        default_text(table, key, style), key.meaning);
  }
  return text + "\n";
}

std::string as_it_is(std::string_view text) { return std::string(text); }

std::string section_as_text(const KeyTable& table) {
  const Style style{as_it_is, as_it_is};
  std::string text = fmt::format("{}: {}\n", table.title, table.about);
  for (const Key& key : table.keys) {
    const std::string usual = default_text(table, key, style);
    const bool is_value = key.default_words.empty() && !key.default_value.empty();
    text += fmt::format("  {:20} {}{}{}\n{:23}{}\n", key.name, text_of(key.value, style), usual.empty() ? "" : "; ",
                        is_value ? "default " + usual : usual, "", key.meaning);
  }
  return text + "\n";
}

}  // namespace

std::vector<const KeyTable*> tables_from(const KeyTable& root) {
  std::vector<const KeyTable*> tables;
  add_with_what_follows(root, tables);
  return tables;
}

std::string keys_as_markdown() {
  std::string text = "## Every key of a launch file\n\n";
  const std::vector<const KeyTable*> of_launch = tables_from(launch_file_keys());
  for (const KeyTable* table : of_launch) text += section_as_markdown(*table);
  text += "## Every key of a scene file\n\n";
  for (const KeyTable* table : tables_from(scene_file_keys())) {
    if (std::ranges::find(of_launch, table) == of_launch.end()) text += section_as_markdown(*table);
  }
  text.pop_back();
  return text;
}

std::string keys_as_text(std::string_view part) {
  std::string text;
  std::vector<const KeyTable*> tables = tables_from(launch_file_keys());
  for (const KeyTable* table : tables_from(scene_file_keys())) {
    if (std::ranges::find(tables, table) == tables.end()) tables.push_back(table);
  }
  for (const KeyTable* table : tables) {
    if (table->title.find(part) != std::string_view::npos) text += section_as_text(*table);
  }
  return text;
}

}  // namespace aurasim::config
