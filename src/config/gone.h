// Keys and values of launch and scene files that earlier versions read and this one does not. The error for one of them
// says what became of it and what to choose instead, beside file:line:column.
#pragma once

#include <string_view>

namespace aurasim::config {

struct Gone {
  std::string_view path;        ///< path of the removed key, as errors name it: "physics.solver"
  std::string_view value = {};  ///< the removed value; empty: the key was removed with all its values
  std::string_view text;        ///< what replaced it, and what to choose instead
};

/// Finds a removed key. Null: the key never existed, or still does.
const Gone* gone_key(std::string_view path);
/// Finds a removed value of a key. Null: the key never had this value, or still has it.
const Gone* gone_value(std::string_view path, std::string_view value);

}  // namespace aurasim::config
