#include "config/key_schema.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace aurasim::config {
namespace {

using Json = nlohmann::ordered_json;

/// A schema while it is being written: the definitions that it has so far.
class Schema {
 public:
  Json of_file(const KeyTable& root) {
    const Json top = reference(root, {});
    Json whole;
    whole["$schema"] = "http://json-schema.org/draft-07/schema#";
    whole["title"] = fmt::format("aurasim {}", root.title);
    whole["description"] = fmt::format("{} Written by scripts/write_keys.sh.", root.about);
    whole["allOf"] = Json::array({top});
    whole["definitions"] = definitions_;
    return whole;
  }

 private:
  Json of_map(const Value& map) {
    Json schemas = Json::array();
    for (const Table& table : map.tables) schemas.push_back(reference(table(), map.shared));
    if (schemas.size() == 1) return schemas[0];
    return any_of(schemas);
  }

  static Json any_of(const Json& schemas) {
    Json any;
    any["anyOf"] = schemas;
    return any;
  }

  Json reference(const KeyTable& table, const std::vector<Table>& shared) {
    std::string name(table.title);
    for (const Table& more : shared) name += fmt::format(", {}", more().title);
    for (char& c : name) c = c == ' ' ? '_' : c;
    if (!definitions_.contains(name)) {
      definitions_[name] = nullptr;  // keeps its place, and ends circles
      std::vector<const KeyTable*> tables = {&table};
      for (const Table& more : shared) tables.push_back(&more());
      definitions_[name] = object(tables);
    }
    return {{"$ref", "#/definitions/" + name}};
  }

  Json object(const std::vector<const KeyTable*>& tables) {
    Json schema = {{"type", "object"}, {"description", tables.front()->about}, {"additionalProperties", false}};
    Json required = Json::array(), unless_central = Json::array(), one_of = Json::array();
    for (const KeyTable* table : tables) {
      for (const Key& key : table->keys) {
        schema["properties"][std::string(key.name)] = property(key);
        if (key.required) required.push_back(key.name);
        if (key.required_unless_central) unless_central.push_back(key.name);
      }
      for (const std::string_view name : table->one_of) one_of.push_back({{"required", Json::array({name})}});
    }
    if (!required.empty()) schema["required"] = required;
    if (!one_of.empty()) schema["oneOf"] = one_of;
    if (!unless_central.empty()) {
      schema["if"] = {{"properties", {{"count", {{"const", 1}}}}}, {"required", Json::array({"count"})}};
      schema["else"] = {{"required", unless_central}};
    }
    return schema;
  }

  Json property(const Key& key) {
    Json value = of(key.value);
    Json schema = {{"description", described(key)}};
    if (!key.default_value.empty()) {
      Json usual = Json::parse(key.default_value, nullptr, false);
      schema["default"] = usual.is_discarded() ? Json(key.default_value) : usual;
    }
    if (value.contains("$ref")) {
      schema["allOf"] = Json::array({value});  // in allOf, because keys beside a $ref are ignored
    } else {
      schema.update(value);
    }
    return schema;
  }

  static std::string described(const Key& key) {
    std::string text(key.meaning);
    if (!key.value.unit.empty()) text += fmt::format(" [{}]", key.value.unit);
    if (!key.default_words.empty()) text += fmt::format("; default: {}", key.default_words);
    return text;
  }

  Json of(const Value& value) {
    if (value.also.empty()) return of_itself(value);
    Json schemas = Json::array({of_itself(value)});
    for (const Value& other : value.also) schemas.push_back(of_itself(other));
    return any_of(schemas);
  }

  Json of_itself(const Value& value) {
    switch (value.kind) {
      case Value::Kind::kNumber:
        return of_number(value.range);
      case Value::Kind::kInteger:
        return {{"type", "integer"}, {"minimum", value.lowest}, {"maximum", value.highest}};
      case Value::Kind::kFlag:
        return {{"type", "boolean"}};
      case Value::Kind::kText:
      case Value::Kind::kName:
        return {{"type", {"string", "number"}}};  // a name may look like a number
      case Value::Kind::kWord:
        return of_words(value.words);
      case Value::Kind::kNumbers:
        return of_list(value, of_number(value.range));
      case Value::Kind::kList:
        return of_list(value, of(value.items.front()));
      case Value::Kind::kMap:
        return of_map(value);
      case Value::Kind::kNamed:
        return {{"type", "object"}, {"additionalProperties", of(value.items.front())}};
    }
    return {};
  }

  static Json of_number(const Range& range) {
    return {
        {"type", "number"}, {range.low_excluded ? "exclusiveMinimum" : "minimum", range.low}, {"maximum", range.high}};
  }

  static Json of_words(const std::vector<Word>& words) {
    Json names = Json::array();
    for (const Word& word : words) names.push_back(word.name);
    return {{"enum", names}};
  }

  static Json of_list(const Value& list, const Json& item) {
    return {{"type", "array"}, {"minItems", list.fewest}, {"maxItems", list.most}, {"items", item}};
  }

  Json definitions_;
};

}  // namespace

std::string key_schema(const KeyTable& root) { return Schema().of_file(root).dump(1) + "\n"; }

}  // namespace aurasim::config
