// Keeps lists up to date that have an entry for each body of a snapshot, when bodies have come or gone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace aurasim::core {

/// Takes the entries `gone` out of a list, and puts `fresh` in so that they have the indices `came` afterwards. Both
/// ascend. The other entries keep their order.
template <class T>
void regroup(std::vector<T>& list, std::span<const std::uint32_t> gone, std::span<const std::uint32_t> came,
             const T& fresh) {
  const auto at = [&list](std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
  std::size_t end = gone.empty() ? list.size() : gone.front();
  for (std::size_t i = 0; i < gone.size(); ++i) {
    const std::size_t next = i + 1 < gone.size() ? gone[i + 1] : list.size();
    std::move(at(gone[i] + 1U), at(next), at(end));
    end += next - gone[i] - 1;
  }
  list.resize(end);
  list.resize(end + came.size(), fresh);
  std::size_t to = list.size();
  for (std::size_t left = came.size(); left > 0; --left) {
    const std::size_t stay = to - came[left - 1] - 1;  // entries behind this one
    std::move_backward(at(end - stay), at(end), at(to));
    end -= stay;
    to = came[left - 1];
    list[to] = fresh;
  }
}

/// In place of the index of a body that has gone.
inline constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// By index before: index after a regroup() of a list of `size` entries, or kGone.
inline std::vector<std::uint32_t> indices_after(std::size_t size, std::span<const std::uint32_t> gone,
                                                std::span<const std::uint32_t> came) {
  std::vector<std::uint32_t> after(size);
  auto next_gone = gone.begin();
  auto next_came = came.begin();
  std::uint32_t now = 0;
  for (std::uint32_t i = 0; i < size; ++i) {
    if (next_gone != gone.end() && *next_gone == i) {
      ++next_gone;
      after[i] = kGone;
      continue;
    }
    for (; next_came != came.end() && *next_came == now; ++next_came) ++now;
    after[i] = now++;
  }
  return after;
}

}  // namespace aurasim::core
