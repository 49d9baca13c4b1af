// Finds a series of ascending values in an ascending list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace aurasim::core {

/// Place of the first entry of `list` whose projection is not less than `value`. `near`: what the last call returned,
/// or any number. Searches from `near` on in steps that double, then between the last two: the search is short where
/// few entries lie between one value and the next.
template <class List, class Value, class Projection>
std::size_t find_ascending(const List& list, const Value& value, Projection projection, std::size_t near) {
  const std::size_t size = list.size();
  const auto is_less = [&](std::size_t place) { return std::invoke(projection, list[place]) < value; };
  const bool is_before = near >= size || value < std::invoke(projection, list[near]);
  std::size_t first = is_before ? 0 : near, last = is_before ? size : near;
  for (std::size_t step = 1; !is_before && last < size && is_less(last); step *= 2) {
    first = last + 1;
    last = std::min(size, last + step);
  }
  const auto at = [&](std::size_t place) { return list.begin() + static_cast<std::ptrdiff_t>(place); };
  return static_cast<std::size_t>(std::ranges::lower_bound(at(first), at(last), value, {}, projection) - list.begin());
}

}  // namespace aurasim::core
