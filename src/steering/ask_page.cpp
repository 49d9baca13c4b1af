#include "steering/ask_page.h"

#include <fmt/format.h>

#include "steering/ask_check.h"

namespace aurasim::steering {
namespace {

using Schema = nlohmann::ordered_json;

std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

void add_row(std::string& page, const Field& field, const std::string& absent) {
  page += fmt::format("| | `{}` | {} | {} | {} |\n", field.name, in_cell(allowed(field)), absent,
                      in_cell(std::string(field.help)));
}

std::string absent_of(const Field& field) { return field.absent.empty() ? "required" : std::string(field.absent); }
std::string absent_of(const Field& field, const AskKind& kind) {
  if (field.name == kind.first) return fmt::format("`{}` is given", kind.second);
  return field.name == kind.second ? fmt::format("`{}` is given", kind.first) : absent_of(field);
}
std::string absent_of(const Field& field, const ShapeKind&) { return absent_of(field); }

template <class Kinds>
void add_kinds(std::string& page, const Kinds& kinds) {
  page += "| kind | field | allowed | without it | meaning |\n|---|---|---|---|---|\n";
  for (const auto& kind : kinds) {
    page += fmt::format("| **`{}`** | | | | {} |\n", kind.name, in_cell(std::string(kind.help)));
    for (const Field& field : kind.fields) add_row(page, field, absent_of(field, kind));
  }
}

Schema list_of_numbers(int count) {
  return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", count}, {"maxItems", count}};
}

Schema form_schema(const Field& field) {
  switch (field.form) {
    case Form::kNumber:
      return {{"type", "number"}, {"minimum", field.low}, {"maximum", field.high}};
    case Form::kWhole:
      return {{"type", "integer"},
              {"minimum", static_cast<std::int64_t>(field.low)},
              {"maximum", static_cast<std::int64_t>(field.high)}};
    case Form::kVector: {
      Schema schema = list_of_numbers(3);
      schema["items"]["minimum"] = field.low;
      schema["items"]["maximum"] = field.high;
      return schema;
    }
    case Form::kLength:
      return list_of_numbers(3);
    case Form::kRotation:
      return list_of_numbers(4);
    case Form::kText:
    case Form::kFileName:
      return {
          {"type", "string"}, {"minLength", static_cast<int>(field.low)}, {"maxLength", static_cast<int>(field.high)}};
    case Form::kSaveName:
      return {{"type", "string"}, {"pattern", "^[A-Za-z0-9_][A-Za-z0-9._-]{0,99}$"}};
    case Form::kStatic:
      return {{"type", {"string", "integer"}}};
    case Form::kBoxes: {
      Schema box = list_of_numbers(4);
      box["items"]["type"] = {"number", "null"};
      return {{"type", "array"},
              {"items", std::move(box)},
              {"minItems", static_cast<int>(field.low)},
              {"maxItems", static_cast<int>(field.high)}};
    }
    case Form::kShape:
      return {{"$ref", "#/$defs/shape"}};
    case Form::kHash:
      return {{"type", "string"}, {"pattern", "^[0-9a-fA-F]{16}$"}};
    case Form::kMeshUse:
      return {{"enum", {"hull", "decomposition"}}};
  }
  return {};
}

Schema field_schema(const Field& field) {
  Schema schema = form_schema(field);
  schema["description"] = field.unit.empty() ? std::string(field.help) : fmt::format("{}, {}", field.help, field.unit);
  return schema;
}

template <class Kind>
Schema kind_schema(const Kind& kind) {
  Schema schema = {{"type", "object"}, {"description", kind.help}, {"additionalProperties", false}};
  schema["properties"]["kind"] = {{"const", kind.name}};
  schema["required"] = {"kind"};
  for (const Field& field : kind.fields) {
    schema["properties"][std::string(field.name)] = field_schema(field);
    if (field.absent.empty()) schema["required"].push_back(field.name);
  }
  return schema;
}

Schema without(Schema required, std::string_view first, std::string_view second) {
  Schema rest = Schema::array();
  for (const Schema& name : required) {
    if (name != Schema(first) && name != Schema(second)) rest.push_back(name);
  }
  return rest;
}

Schema ask_kind_schema(const AskKind& kind) {
  Schema schema = kind_schema(kind);
  schema["properties"][std::string(at_field().name)] = field_schema(at_field());
  if (kind.first.empty()) return schema;
  schema["required"] = without(schema["required"], kind.first, kind.second);
  schema["oneOf"] = {{{"required", {kind.first}}}, {{"required", {kind.second}}}};
  return schema;
}

}  // namespace

std::string asks_as_markdown() {
  std::string page = "Fields of every ask:\n\n| field | allowed | without it | meaning |\n|---|---|---|---|\n";
  page += "| `kind` | one of those below | required | what is asked |\n";
  page += fmt::format("| `{}` | {} | {} | {} |\n\n", at_field().name, allowed(at_field()), at_field().absent,
                      at_field().help);
  add_kinds(page, asks());
  page += "\nShapes, the objects in the field `shape`:\n\n";
  add_kinds(page, shapes());
  return page;
}

std::string ask_schema() {
  Schema schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", "what a run of aurasim can be asked"}};
  schema["oneOf"] = Schema::array();
  for (const AskKind& kind : asks()) schema["oneOf"].push_back(ask_kind_schema(kind));
  schema["$defs"]["shape"]["oneOf"] = Schema::array();
  for (const ShapeKind& kind : shapes()) schema["$defs"]["shape"]["oneOf"].push_back(kind_schema(kind));
  return schema.dump(2) + "\n";
}

}  // namespace aurasim::steering
