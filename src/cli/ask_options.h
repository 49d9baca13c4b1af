// The options of `aurasim send KIND`, made from the declaration of the ask (steering/ask.h).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "steering/ask.h"

namespace aurasim::cli {

class AskOptions {
 public:
  explicit AskOptions(const steering::AskKind& kind) : kind_(kind) {}
  AskOptions(const AskOptions&) = delete;
  AskOptions& operator=(const AskOptions&) = delete;

  /// Adds an option for each field. This object must outlive `command`'s parsing.
  void add_to(CLI::App& command);
  /// The ask as the command line gives it.
  nlohmann::json ask() const;

 private:
  struct Value {
    CLI::Option* option = nullptr;
    std::vector<double> numbers;
    std::string text;
    std::uint64_t whole = 0;
    bool flag = false;
  };

  void add(CLI::App& command, const steering::Field& field);
  void add_shape(CLI::App& command);
  Value& value_of(std::string_view name) { return values_[std::string(name)]; }
  bool is_given(const char* name) const;
  nlohmann::json value_json(const steering::Field& field) const;
  nlohmann::json shape_json() const;

  const steering::AskKind& kind_;
  std::map<std::string, Value> values_;  ///< by the names of options
};

}  // namespace aurasim::cli
