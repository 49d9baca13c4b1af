// What somebody meant who mistyped a word.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aurasim::cli {

/// Letters to insert, remove, replace or swap with the next one until `a` is `b`.
std::size_t typing_distance(std::string_view a, std::string_view b);

/// The first of `known` with the least distance; nothing when that is more than a third of the word, and more than 2.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace aurasim::cli
