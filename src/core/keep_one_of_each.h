// Lists without repeated items.
#pragma once

#include <algorithm>
#include <functional>

namespace aurasim::core {

/// Sorts a list by key(item), ascending, and keeps one item of each key.
template <class List, class Key = std::identity>
void keep_one_of_each(List& list, Key key = {}) {
  std::ranges::sort(list, {}, key);
  const auto twins = std::ranges::unique(list, {}, key);
  list.erase(twins.begin(), twins.end());
}

}  // namespace aurasim::core
