// The contents of launch and scene files as tables of keys. The readers use these tables (Fields), and the page of all
// keys and the JSON schemas are printed from them (key_page, key_schema), so that each key is described only once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/limits.h"

namespace aurasim::config {

/// The range of numbers that a field may have. All are finite.
struct Range {
  double low = 0;
  double high = 0;
  bool low_excluded = false;

  static constexpr Range from_to(double low, double high) { return {low, high, false}; }
  static constexpr Range above(double low, double high) { return {low, high, true}; }

  bool contains(double value) const { return (low_excluded ? value > low : value >= low) && value <= high; }
  std::string text() const;
};

/// Range of any coordinate or component, in the unit of the field: far beyond use, far from overflow.
inline constexpr Range kAnyNumber = Range::from_to(-1e7, 1e7);
/// Range of a coordinate in the world, m.
inline constexpr Range kPlace = Range::from_to(-core::limits::kFarthestPlace_m, core::limits::kFarthestPlace_m);
/// Range of a radius, an edge or a height, m.
inline constexpr Range kSize = Range::from_to(core::limits::kSmallestSize_m, core::limits::kLargestSize_m);

struct KeyTable;
/// A table, made when first asked for, because tables may refer to each other in circles (parts of a shape are shapes).
using Table = std::function<const KeyTable&()>;

/// A word of a choice, and its meaning: an enumerator, as a number.
struct Word {
  std::string_view name;
  std::int64_t meaning = 0;
};

/// The values that a key may have.
struct Value {
  enum class Kind : std::uint8_t {
    kNumber,
    kInteger,
    kFlag,
    kText,
    kWord,     ///< one of `words`
    kName,     ///< the name of a thing of kind `what` ("shape") in the scene
    kNumbers,  ///< a list of `most` numbers
    kList,     ///< a list of `fewest` to `most` values, each like the one in `items`
    kMap,      ///< a map with the keys of one of `tables`, and those of `shared`
    kNamed,    ///< a map whose keys are names that the author makes up; values like the one in `items`
  };

  Kind kind = Kind::kText;
  Range range = {};
  std::int64_t lowest = 0, highest = 0;  ///< range of an integer
  std::string_view unit = {};
  std::size_t fewest = 0, most = 0;
  std::vector<Word> words = {};
  std::string_view what = {};  ///< description: "a name", "an XML file"; kNamed: "a map of materials by name"
  std::vector<Value> items = {};
  std::vector<Table> tables = {};
  std::vector<Table> shared = {};
  std::vector<Value> also = {};  ///< alternative values

  Value or_word(std::string_view word) &&;
  Value or_else(Value other) &&;
  /// For a map: adds the keys of this table.
  Value with(Table more) &&;

  /// Returns this value or its alternative of kind `wanted`; null if there is none.
  const Value* as(Kind wanted) const;
  bool has_word(std::string_view word) const;
};

Value number(const Range& range, std::string_view unit = "");
Value integer(std::int64_t low, std::int64_t high, std::string_view unit = "");
Value flag();
Value text(std::string_view what);
/// Returns a choice of words without other meaning.
Value words(std::initializer_list<std::string_view> names);
Value name_of(std::string_view kind);
Value numbers(std::size_t count, const Range& each, std::string_view unit = "");
Value vec3(std::string_view unit = "", const Range& each = kAnyNumber);
Value list(std::size_t fewest, std::size_t most, Value item);
Value map(Table table);
Value map_of_one(std::vector<Table> tables);
Value named(std::string_view what, Value entry);

template <class E>
Value choice(std::initializer_list<std::pair<std::string_view, E>> choices) {
  Value value{.kind = Value::Kind::kWord};
  for (const auto& [name, meaning] : choices) value.words.push_back({name, static_cast<std::int64_t>(meaning)});
  return value;
}

struct Key {
  std::string_view name = {};
  bool required = false;
  Value value = {};
  std::string_view meaning = {};
  std::string default_value = {};        ///< as YAML; empty: none, or see default_words
  std::string default_words = {};        ///< effect of leaving the key out, if that is no value
  bool required_unless_central = false;  ///< required, except beside `count: 1`

  Key usual(std::string yaml) &&;
  Key otherwise(std::string words) &&;
};

Key required(std::string_view name, Value value, std::string_view meaning);
Key required_unless_central(std::string_view name, Value value, std::string_view meaning);
Key optional(std::string_view name, Value value, std::string_view meaning);

/// A map whose keys are known beforehand.
struct KeyTable {
  std::string_view title = {};  ///< title of its section on the page; unique
  std::string_view about = {};
  std::vector<Key> keys = {};
  std::vector<std::string_view> one_of = {};  ///< exactly one of these keys must be there

  const Key* find(std::string_view name) const;
};

/// True when a map must have `key`, given the text of its `count` (empty: there is none).
bool is_required(const Key& key, std::string_view count);

/// Top tables of a launch file and of a scene file.
const KeyTable& launch_file_keys();
const KeyTable& scene_file_keys();

}  // namespace aurasim::config
