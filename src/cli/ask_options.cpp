#include "cli/ask_options.h"

#include <cmath>

#include <fmt/format.h>

namespace aurasim::cli {
namespace {

using nlohmann::json;
using steering::Field;
using steering::Form;

std::string text_for(const Field& field) {
  std::string text(field.help);
  if (!field.unit.empty()) text += fmt::format(", {}", field.unit);
  if (field.low < field.high && (field.form == Form::kNumber || field.form == Form::kWhole) && field.high < 1e9) {
    text += fmt::format(", {:g} to {:g}", field.low, field.high);
  }
  if (!field.absent.empty()) text += fmt::format("; otherwise {}", field.absent);
  return text;
}

int count_of(Form form) { return form == Form::kRotation ? 4 : form == Form::kNumber ? 1 : 3; }

/// Rows of four. JSON has no infinite numbers; null stands for them.
json boxes_json(const std::vector<double>& numbers) {
  json boxes = json::array();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i % 4 == 0) boxes.push_back(json::array());
    const bool is_outside = std::isinf(numbers[i]) && (numbers[i] > 0) == (i % 4 >= 2);
    boxes.back().push_back(is_outside ? json(nullptr) : json(numbers[i]));
  }
  return boxes;
}

}  // namespace

void AskOptions::add_to(CLI::App& command) {
  for (const Field& field : kind_.fields) add(command, field);
  if (!kind_.first.empty() && kind_.of_second.empty()) {
    value_of(kind_.first).option->excludes(value_of(kind_.second).option);
  }
  add(command, steering::at_field());
}

void AskOptions::add(CLI::App& command, const Field& field) {
  if (field.form == Form::kShape) return add_shape(command);
  Value& value = value_of(field.name);
  const std::string text = text_for(field);
  const std::string name = field.is_argument && field.form == Form::kSaveName ? "WORLD"
                           : field.is_argument                                ? "REGION"
                                                                              : fmt::format("--{}", field.name);
  switch (field.form) {
    case Form::kNumber:
    case Form::kVector:
    case Form::kLength:
    case Form::kRotation:
      value.option = command.add_option(name, value.numbers, text)->expected(count_of(field.form));
      break;
    case Form::kBoxes:
      value.option = command.add_option(name, value.numbers, text)->expected(4, 4 * static_cast<int>(field.high));
      break;
    case Form::kWhole:
      value.option = command.add_option(name, value.whole, text);
      break;
    default:
      value.option = command.add_option(name, value.text, text);
      break;
  }
  value.option->default_str("");
  const bool is_alternative = field.name == kind_.first || field.name == kind_.second;
  if (field.absent.empty() && !is_alternative) value.option->required();
}

void AskOptions::add_shape(CLI::App& command) {
  using steering::field_of;
  const auto numbers = [&](const char* name, const std::string& text, int count) {
    Value& value = value_of(name);
    value.option = command.add_option(fmt::format("--{}", name), value.numbers, text)->expected(count);
    value.option->default_str("");
  };
  numbers("size", "a box: " + text_for(field_of("box", "size")), 3);
  numbers("radius", "a ball: " + text_for(field_of("sphere", "radius")) + "; with --height a capsule along z", 1);
  numbers("height", text_for(field_of("capsule", "height")), 1);
  Value& mesh = value_of("mesh");
  mesh.option = command.add_option("--mesh", mesh.text, "OBJ, STL or glTF file; bodies take its hull")
                    ->check(CLI::ExistingFile)
                    ->default_str("");
  if (kind_.name != "spawn") return;
  Value& parts = value_of("parts");
  parts.option = command.add_flag("--parts", parts.flag,
                                  "with --mesh: convex parts that it is taken apart into, instead of its hull");
}

bool AskOptions::is_given(const char* name) const {
  const auto found = values_.find(name);
  return found != values_.end() && found->second.option->count() > 0;
}

json AskOptions::shape_json() const {
  if (is_given("mesh")) {
    json mesh = {{"kind", "mesh"}, {"file", values_.at("mesh").text}};
    if (is_given("parts")) mesh["as"] = "decomposition";
    return mesh;
  }
  if (is_given("size")) return {{"kind", "box"}, {"size", values_.at("size").numbers}};
  if (!is_given("radius")) return nullptr;
  json round = {{"kind", "sphere"}, {"radius", values_.at("radius").numbers.front()}};
  if (!is_given("height")) return round;
  round["kind"] = "capsule";
  round["height"] = values_.at("height").numbers.front();
  return round;
}

json AskOptions::value_json(const Field& field) const {
  const Value& value = values_.at(std::string(field.name));
  switch (field.form) {
    case Form::kNumber:
      return value.numbers.front();
    case Form::kVector:
    case Form::kLength:
    case Form::kRotation:
      return value.numbers;
    case Form::kBoxes:
      return boxes_json(value.numbers);
    case Form::kWhole:
      return value.whole;
    default:
      return value.text;
  }
}

json AskOptions::ask() const {
  json ask = {{"kind", kind_.name}};
  for (const Field& field : kind_.fields) {
    if (field.form == Form::kShape) {
      if (json shape = shape_json(); !shape.is_null()) ask["shape"] = std::move(shape);
    } else if (is_given(std::string(field.name).c_str())) {
      ask[std::string(field.name)] = value_json(field);
    }
  }
  if (is_given("at")) ask["at"] = values_.at("at").whole;
  return ask;
}

}  // namespace aurasim::cli
