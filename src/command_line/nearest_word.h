// Finds the known word that is nearest to a mistyped one.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::command_line {

/// Number of letters to insert, remove, replace, or swap with the next one to turn `a` into `b`.
std::size_t typing_distance(std::string_view a, std::string_view b);

/// The first of `known` with the least distance to `word`. Nothing if the distance is more than 2 and more than a third
/// of the word.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace aurasim::command_line
