#include "core/regroup.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

/// Entries that are named by their bodies' ids.
TEST(Regroup, EntriesKeepTheirOrderAndFreshOnesAreWhereTheyCame) {
  std::mt19937_64 random(1);
  for (int n = 0; n < 500; ++n) {
    std::vector<int> before, after;
    std::vector<std::uint32_t> gone, came;
    for (int id = 0; id < static_cast<int>(random() % 20); ++id) {
      const bool was = random() % 3 != 0, is = random() % 3 != 0;
      if (was && !is) gone.push_back(static_cast<std::uint32_t>(before.size()));
      if (is && !was) came.push_back(static_cast<std::uint32_t>(after.size()));
      if (was) before.push_back(id);
      if (is) after.push_back(was ? id : -1);
    }
    std::vector<int> list = before;
    regroup(list, gone, came, -1);
    EXPECT_EQ(list, after);
    const std::vector<std::uint32_t> now_at = indices_after(before.size(), gone, came);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const auto found = std::ranges::find(after, before[i]);
      EXPECT_EQ(now_at[i], found == after.end() ? kGone : static_cast<std::uint32_t>(found - after.begin()));
    }
  }
}

}  // namespace
}  // namespace aurasim::core
