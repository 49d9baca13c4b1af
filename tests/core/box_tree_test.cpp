// The tree of boxes, against looking at every pair.
#include "core/box_tree.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"

namespace aurasim::core::testing {
namespace {

using Box = BoxTree::Box;

std::vector<Box> random_boxes(Random& random, std::size_t count, double world_m, double size_m) {
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 middle = random.in_box(world_m), half = random.in_box(size_m).cwiseAbs();
    boxes.push_back({middle - half, middle + half});
  }
  return boxes;
}

TEST(ABoxTree, FindsAllThatMeetABoxOnce) {
  Random random("boxes", 7);
  for (const std::size_t count : {0, 1, 4, 5, 100, 333}) {
    const std::vector<Box> boxes = random_boxes(random, count, 10, 2);
    const BoxTree tree(boxes);
    for (const Box& box : random_boxes(random, 50, 10, 3)) {
      std::vector<int> found(count);
      EXPECT_FALSE(tree.any(box, [&](std::uint32_t i) {
        ++found[i];
        return false;
      }));
      for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(found[i], boxes[i].meets(box)) << i;
    }
  }
}

TEST(ABoxTree, StopsAtWhatIsWanted) {
  Random random("boxes", 8);
  const std::vector<Box> boxes = random_boxes(random, 200, 1, 2);
  int looked_at = 0;
  EXPECT_TRUE(BoxTree(boxes).any(boxes[0], [&](std::uint32_t) { return ++looked_at == 2; }));
  EXPECT_EQ(looked_at, 2);
}

/// One look finds another box; a second one is needed where the first was at the box itself. All pairs would be 5
/// thousand millions.
TEST(ABoxTree, LooksAtFewWhereAllAreInOnePlace) {
  constexpr std::uint32_t kBoxes = 100'000;
  for (const double spread_m : {0.0, 0.01}) {
    Random random("boxes in one place", 9);
    std::vector<Box> boxes;
    for (std::uint32_t i = 0; i < kBoxes; ++i) {
      const Vec3 middle = random.in_box(spread_m);
      boxes.push_back({middle - Vec3::Ones(), middle + Vec3::Ones()});
    }
    const BoxTree tree(boxes);
    std::uint32_t looks = 0, met = 0;
    for (std::uint32_t i = 0; i < kBoxes; ++i) {
      met += tree.any(boxes[i], [&](std::uint32_t j) {
        ++looks;
        return j != i;
      });
    }
    EXPECT_EQ(met, kBoxes);
    EXPECT_LE(looks, 2 * kBoxes);
  }
}

}  // namespace
}  // namespace aurasim::core::testing
