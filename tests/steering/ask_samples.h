// Asks for tests: one of each declared kind with every field, and each with a field that is out of range.
#pragma once

#include <string>
#include <vector>

#include "steering/ask.h"

namespace aurasim::steering::testing {

using Json = nlohmann::json;

/// A value that is allowed.
inline Json sound_value(const Field& field) {
  switch (field.form) {
    case Form::kNumber:
      return field.high;
    case Form::kWhole:
      return 7;
    case Form::kVector:
      return field.low < 0 ? Json{1, -2, 3.5} : Json{1, 2, 3.5};
    case Form::kLength:
      return Json{3, -4, 0};
    case Form::kRotation:
      return Json{0, 0, 1, 0};
    case Form::kText:
    case Form::kFileName:
    case Form::kSaveName:
      return "name_1";
    case Form::kStatic:
      return 3;
    case Form::kBoxes:
      return Json{{-9, -9, 0, 9}, {0, -5, 9, 5}};
    case Form::kShape:
      return {{"kind", "box"}, {"size", {1, 2, 3}}};
    case Form::kHash:
      return "00000000000000ff";
    case Form::kMeshUse:
      return "decomposition";
  }
  return nullptr;
}

/// Values that are out of the field's range, or of another form.
inline std::vector<Json> wrong_values(const Field& field) {
  switch (field.form) {
    case Form::kNumber:
      return {field.high * 1.001, field.low - 1, "1", Json::array(), nullptr};
    case Form::kWhole:
      return {-1, 0.5, 1e300, "1", nullptr};
    case Form::kVector:
      return {Json{field.high * 1.1, 0, 0}, Json{1, 2}, Json{1, 2, nullptr}, Json{1, 2, "3"}, 1, nullptr};
    case Form::kLength:
      return {Json{field.high, field.high, 0}, Json{1, 2, 3, 4}, Json{1, 2, nullptr}, nullptr};
    case Form::kRotation:
      return {Json{0, 0, 0, 0}, Json{1, 0, 0}, Json{1, 0, 0, 1e300}, nullptr};
    case Form::kText:
      return {"", std::string(5000, 'x'), 1, nullptr};
    case Form::kFileName:
    case Form::kSaveName:
      return {"", "../x", ".x", std::string(101, 'x'), 1, nullptr};
    case Form::kStatic:
      return {"", -1, 1.5, std::uint64_t{1} << 32U, Json::array(), nullptr};
    case Form::kBoxes:
      return {Json::array(), Json{{1, 0, 0, 1}}, Json{{0, 0, 1}}, Json{1, 2, 3, 4}, nullptr};
    case Form::kShape:
      return {1, Json::object(), {{"kind", "cone"}}, nullptr};
    case Form::kHash:
      return {"xyz", "00000000000000f", 255, nullptr};
    case Form::kMeshUse:
      return {"triangles", 1, nullptr};
  }
  return {};
}

/// The ask with all fields that go together. Where two exclude each other, it has the second.
inline Json whole_ask(const AskKind& kind) {
  Json ask = {{"kind", kind.name}, {"at", 400}};
  for (const Field& field : kind.fields) {
    if (field.name != kind.first) ask[std::string(field.name)] = sound_value(field);
  }
  return ask;
}

/// An ask whose field `name` has this value.
inline Json ask_with(const AskKind& kind, const Field& field, Json value) {
  Json ask = whole_ask(kind);
  if (field.name == kind.first) {
    ask.erase(std::string(kind.second));
    if (!kind.of_second.empty()) ask.erase(std::string(kind.of_second));
  }
  ask[std::string(field.name)] = std::move(value);
  return ask;
}

/// Why the ask is refused; empty: it is not.
inline std::string refusal_of(const Json& ask, MeshFiles files = MeshFiles::kAllowed) {
  try {
    read_ask(ask, files);
    return {};
  } catch (const BadAsk& bad) {
    return bad.what();
  }
}

}  // namespace aurasim::steering::testing
