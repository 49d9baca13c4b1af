// Every key of the tables is taken by the reader with its default and at the ends of its range, and refused beyond
// them; and the page and the schemas say what the tables say.
#include "config/keys.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "config/fields.h"
#include "config/key_page.h"
#include "config/key_schema.h"
#include "config/workspace.h"

namespace aurasim::config {
namespace {

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Of things that samples refer to by name, by the key whose map or list they stand in.
const std::map<std::string_view, std::string> kKnown = {
    {"materials", "stone: {}"},
    {"shapes", "ball: {sphere: {radius: 0.3}}"},
    {"prototypes", "ball: {shape: ball, mass: 1}"},
    {"bodies", "{prototype: ball, name: someone}"},
};

/// Where the sample of a table has to be more than a sample of each required key.
const std::map<std::string_view, std::string> kSamples = {
    {"points", "[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]"},
    {"boxes", "[[0, 0, 40, 40], [40, 0, 80, 40]]"},
    {"total_height", "3"},
};

std::string sample_of(const Key& key);
std::string sample_of(const Value& value);

std::string number_text(double number) { return fmt::format("{}", number); }

std::string times(std::size_t count, const std::string& item) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + item;
  return fmt::format("[{}]", text);
}

double within(const Range& range) { return range.contains(1) ? 1 : range.high; }

using Tables = std::vector<const KeyTable*>;

Tables tables_of(const Value& map, std::size_t which) {
  Tables tables = {&map.tables[which]()};
  for (const Table& more : map.shared) tables.push_back(&more());
  return tables;
}

/// A map with all that is required, and `key` with that text.
std::string map_with(const Tables& tables, const Key* key, const std::string& text) {
  std::string body;
  const auto add = [&](std::string_view name, const std::string& value) {
    body += fmt::format("{}{}: {}", body.empty() ? "" : ", ", name, value);
  };
  for (const KeyTable* table : tables) {
    const auto is_choice = [&](std::string_view name) {
      return std::ranges::find(table->one_of, name) != table->one_of.end();
    };
    const bool chosen = key != nullptr && is_choice(key->name);
    if (!table->one_of.empty() && !chosen) add(table->one_of[0], sample_of(*table->find(table->one_of[0])));
    for (const Key& other : table->keys) {
      if (&other == key || !is_required(other, "")) continue;
      if (key != nullptr && key->name == "count" && other.name == "boxes") continue;
      add(other.name, sample_of(other));
    }
  }
  if (key != nullptr) add(key->name, text);
  return fmt::format("{{{}}}", body);
}

std::string sample_of(const Value& value) {
  switch (value.kind) {
    case Value::Kind::kNumber:
      return number_text(within(value.range));
    case Value::Kind::kInteger:
      return std::to_string(std::max<std::int64_t>(value.lowest, 1));
    case Value::Kind::kFlag:
      return "true";
    case Value::Kind::kText:
      if (value.what == "a scene file") return "scene.yaml";
      if (value.what == "another scene file") return "part.yaml";
      if (value.what == "an XML file") return "qos.xml";
      if (value.what == "a folder") return ".";
      if (value.what == "an address") return "127.0.0.1";
      return value.what == "a name" ? "it" : "it.obj";
    case Value::Kind::kWord:
      return std::string(value.words.back().name);
    case Value::Kind::kName:
      if (value.what == "material") return "stone";
      return value.what == "named body" ? "someone" : value.what == "joint" ? "joint 0" : "ball";
    case Value::Kind::kNumbers:
      return times(value.most, number_text(within(value.range)));
    case Value::Kind::kList:
      return times(std::max<std::size_t>(value.fewest, 1), sample_of(value.items[0]));
    case Value::Kind::kMap:
      return map_with(tables_of(value, 0), nullptr, "");
    case Value::Kind::kNamed:
      return fmt::format("{{it: {}}}", sample_of(value.items[0]));
  }
  return "";
}

std::string sample_of(const Key& key) {
  if (const auto sample = kSamples.find(key.name); sample != kSamples.end()) return sample->second;
  const auto known = kKnown.find(key.name);
  const bool holds_maps = !key.value.items.empty() && key.value.items[0].kind == Value::Kind::kMap;
  if (known == kKnown.end() || !holds_maps) return sample_of(key.value);
  return key.name == "bodies" ? fmt::format("[{}]", known->second) : fmt::format("{{{}}}", known->second);
}

/// A key of some map, how that map becomes a whole file, and the path that errors name the key by.
struct Case {
  Tables tables;
  const Key* key;
  std::function<std::string(const std::string&)> file_of;
  std::string path;

  std::string file_with(const std::string& text) const { return file_of(map_with(tables, key, text)); }
  std::string file_without() const { return file_of(map_with(tables, nullptr, "")); }
};

using Wrap = std::function<std::string(const std::string&)>;

void add_cases(const Tables& tables, const Wrap& file_of, const std::string& path, std::vector<Case>& cases);

void add_cases_below(const Value& value, const Wrap& file_of, const std::string& path, std::vector<Case>& cases) {
  for (std::size_t i = 0; i < value.tables.size(); ++i) add_cases(tables_of(value, i), file_of, path, cases);
  for (const Value& other : value.also) add_cases_below(other, file_of, path, cases);
  if (value.items.empty()) return;
  const bool named = value.kind == Value::Kind::kNamed;
  const auto known = kKnown.find(path);
  const std::string before = known == kKnown.end() ? "" : known->second + ", ";
  const Wrap in_list = [=](const std::string& text) {
    return file_of(named ? fmt::format("{{{}it: {}}}", before, text) : fmt::format("[{}{}]", before, text));
  };
  add_cases_below(value.items[0], in_list, path + (named ? ".it" : before.empty() ? "[0]" : "[1]"), cases);
}

void add_cases(const Tables& tables, const Wrap& file_of, const std::string& path, std::vector<Case>& cases) {
  for (const KeyTable* table : tables) {
    for (const Key& key : table->keys) {
      const Case one{tables, &key, file_of, path_to(path, key.name)};
      cases.push_back(one);
      add_cases_below(
          key.value, [one](const std::string& text) { return one.file_with(text); }, one.path, cases);
    }
  }
}

/// A scene in which everything is there that samples name, unless `body` says otherwise.
std::string scene_of(const std::string& body) {
  std::string text = "{";
  const auto add = [&](std::string_view key, const std::string& value) {
    if (!body.starts_with(fmt::format("{{{}:", key))) text += fmt::format("{}: {}, ", key, value);
  };
  add("layout", "{layout: columns, count: 2, width: 40}");
  for (const auto& [key, entries] : kKnown)
    add(key, key == "bodies" ? fmt::format("[{}]", entries) : fmt::format("{{{}}}", entries));
  return text + body.substr(1);
}

/// The innermost value of lists.
const Value& innermost(const Value& value) {
  return value.kind == Value::Kind::kList ? innermost(value.items[0]) : value;
}

/// A value with this text in place of each number in it.
std::string with_number(const Value& value, const std::string& text) {
  if (value.kind == Value::Kind::kList) {
    return times(std::max<std::size_t>(value.fewest, 1), with_number(value.items[0], text));
  }
  return value.kind == Value::Kind::kNumbers ? times(value.most, text) : text;
}

struct Ends {
  std::vector<std::string> taken;
  std::vector<std::string> refused;
};

Ends ends_of(const Value& value) {
  if (value.kind == Value::Kind::kInteger) {
    const bool largest = value.highest == std::numeric_limits<std::int64_t>::max();
    return {{std::to_string(value.lowest), std::to_string(value.highest)},
            {std::to_string(value.lowest - 1), largest ? "9223372036854775808" : std::to_string(value.highest + 1)}};
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double low = value.range.low, high = value.range.high;
  Ends ends{{number_text(high)}, {number_text(std::nextafter(high, kInfinity))}};
  (value.range.low_excluded ? ends.refused : ends.taken).push_back(number_text(low));
  ends.refused.push_back(number_text(std::nextafter(low, -kInfinity)));
  return ends;
}

/// Of a launch file or of a scene file.
struct FileKind {
  const char* name;
  const KeyTable& (*root)();
  Wrap file_of;

  std::vector<Case> cases() const {
    std::vector<Case> all;
    add_cases({&root()}, file_of, "", all);
    return all;
  }
};

void PrintTo(const FileKind& kind, std::ostream* out) { *out << kind.name; }

class EveryKey : public testing::TestWithParam<FileKind> {
 protected:
  EveryKey() {
    workspace_.write("qos.xml", "<dds/>");
    workspace_.write("part.yaml", "{}");
    workspace_.write("it.obj", kTetrahedron);
  }

  bool is_scene() const { return GetParam().root == scene_file_keys; }

  /// Those that name the key itself, or a value in its list.
  std::vector<std::string> errors_at(const Case& one, const std::string& text) const {
    const std::string file = one.file_with(text);
    std::vector<std::string> errors = is_scene() ? workspace_.scene_errors(file) : workspace_.launch_errors(file);
    std::erase_if(errors, [&](const std::string& error) {
      return (error.find(": " + one.path + ": ") == std::string::npos &&
              error.find(": " + one.path + "[") == std::string::npos) ||
             is_about_others(error);
    });
    return errors;
  }

  /// What is wrong only since the file says so little.
  static bool is_about_others(const std::string& error) {
    return error.find("found no drive beside it") != std::string::npos ||
           error.find("found the joint itself") != std::string::npos;
  }

  bool range_is_refused(const Case& one, const std::string& text) const {
    return std::ranges::any_of(errors_at(one, text), [](const std::string& error) {
      return error.find("a number ") != std::string::npos || error.find("an integer ") != std::string::npos;
    });
  }

  /// Nothing if the file cannot be read.
  std::optional<std::uint64_t> agreement(const std::string& text) const {
    try {
      if (!is_scene()) return workspace_.launch(text).agreement();
      workspace_.write("scene.yaml", text);
      return read_launch(workspace_.write("launch.yaml", kSmallLaunch)).agreement();
    } catch (const BadConfig&) {
      return std::nullopt;
    }
  }

  Workspace workspace_;
};

TEST_P(EveryKey, IsTakenWithItsDefaultAndWithASample) {
  for (const Case& one : GetParam().cases()) {
    for (const std::string& text : {one.key->default_value, sample_of(*one.key)}) {
      if (!text.empty()) {
        EXPECT_THAT(errors_at(one, text), testing::IsEmpty()) << one.file_with(text);
      }
    }
  }
}

TEST_P(EveryKey, HasTheDefaultThatItsTableSays) {
  int compared = 0;
  for (const Case& one : GetParam().cases()) {
    if (one.key->default_value.empty()) continue;
    const auto without = agreement(one.file_without());
    const auto with = agreement(one.file_with(one.key->default_value));
    EXPECT_EQ(with, without) << one.path << ": " << one.key->default_value;
    compared += with.has_value() ? 1 : 0;
  }
  EXPECT_GE(compared, 20);
}

TEST_P(EveryKey, HasTheRangeThatItsTableSays) {
  int numbers = 0;
  for (const Case& one : GetParam().cases()) {
    const Value& value = innermost(one.key->value);
    const bool is_number = value.kind == Value::Kind::kNumber || value.kind == Value::Kind::kInteger ||
                           value.kind == Value::Kind::kNumbers;
    if (!is_number) continue;
    ++numbers;
    const Ends ends = ends_of(value);
    for (const std::string& end : ends.taken) {
      EXPECT_FALSE(range_is_refused(one, with_number(one.key->value, end))) << one.path << ": " << end;
    }
    for (const std::string& end : ends.refused) {
      EXPECT_TRUE(range_is_refused(one, with_number(one.key->value, end))) << one.path << ": " << end;
    }
  }
  EXPECT_GE(numbers, 20);
}

TEST_P(EveryKey, RefusesWhatIsOfAnotherKind) {
  for (const Case& one : GetParam().cases()) {
    EXPECT_THAT(errors_at(one, "[[[no such thing]]]"), testing::Not(testing::IsEmpty())) << one.path;
  }
}

TEST_P(EveryKey, HasAMeaningAndSaysWhatHoldsWithoutIt) {
  for (const Case& one : GetParam().cases()) {
    const Key& key = *one.key;
    EXPECT_FALSE(key.meaning.empty()) << one.path;
    const bool is_one_of = std::ranges::any_of(one.tables, [&](const KeyTable* table) {
      return std::ranges::find(table->one_of, key.name) != table->one_of.end();
    });
    const bool leads_on = key.value.kind == Value::Kind::kMap || key.value.kind == Value::Kind::kList ||
                          key.value.kind == Value::Kind::kNamed;
    EXPECT_TRUE(key.required || key.required_unless_central || is_one_of || leads_on || !key.default_value.empty() ||
                !key.default_words.empty())
        << one.path << " is optional and has no default";
  }
}

INSTANTIATE_TEST_SUITE_P(Of, EveryKey,
                         testing::Values(FileKind{"LaunchFiles", launch_file_keys,
                                                  [](const std::string& text) { return text; }},
                                         FileKind{"SceneFiles", scene_file_keys, scene_of}),
                         [](const auto& test) { return std::string(test.param.name); });

std::string text_of_doc(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(std::filesystem::path(AURASIM_SOURCE_DIR) / "docs" / name, std::ios::binary).rdbuf();
  return text.str();
}

TEST(KeysOnPaper, ThePageSaysWhatTheTablesSay) {
  const bool is_there = text_of_doc("keys.md").find("-->\n" + keys_as_markdown() + "<!--") != std::string::npos;
  EXPECT_TRUE(is_there) << "after a change of keys: scripts/write_keys.sh";
}

TEST(KeysOnPaper, TheSchemasSayWhatTheTablesSay) {
  EXPECT_TRUE(text_of_doc("aurasim-launch.schema.json") == key_schema(launch_file_keys())) << "scripts/write_keys.sh";
  EXPECT_TRUE(text_of_doc("aurasim-scene.schema.json") == key_schema(scene_file_keys())) << "scripts/write_keys.sh";
}

TEST(KeysOnPaper, SectionsAreNamedOnce) {
  std::map<std::string_view, const KeyTable*> by_title;
  for (const auto root : {launch_file_keys, scene_file_keys}) {
    for (const KeyTable* table : tables_from(root())) {
      EXPECT_EQ(by_title.try_emplace(table->title, table).first->second, table) << table->title;
    }
  }
}

}  // namespace
}  // namespace aurasim::config
