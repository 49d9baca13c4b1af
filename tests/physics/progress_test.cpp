// A step marks its progress inside: whoever watches it tells a long one from one that hangs.
#include "core/progress.h"

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

/// Marks in the first step of so many boxes, each of which overlaps all others.
std::uint64_t marks_of_a_heap(Solver solver, int edge) {
  core::Scene scene = scene_of(core::Box{});
  Settings settings;
  settings.solver = solver;
  RegionWorld world(scene, settings);
  std::vector<core::BodyRecord> boxes;
  for (int i = 0; i < edge * edge * edge; ++i) {
    const core::Vec3 place(i % edge, i / edge % edge, i / edge / edge);
    boxes.push_back(body(static_cast<std::uint64_t>(i), 0, core::Vec3(0, 0, 5) + 0.05 * place));
  }
  world.add(boxes);
  const std::uint64_t before = core::Progress::marks();
  world.step();
  return core::Progress::marks() - before;
}

class Heap : public ::testing::TestWithParam<Solver> {};

/// 27 boxes are 351 pairs, 216 are 23,220.
TEST_P(Heap, TheMoreWorkInAStepTheMoreMarks) {
  const std::uint64_t few = marks_of_a_heap(GetParam(), 3), many = marks_of_a_heap(GetParam(), 6);
  EXPECT_GT(few, 0U);
  EXPECT_GT(many, 23'220U / 16);
  EXPECT_GT(many, 5 * few);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Heap,
                         ::testing::Values(Solver::kSequentialImpulse, Solver::kNncg, Solver::kSoftStep));

TEST(Progress, ADirectSolverIsNotLookedInto) {
  EXPECT_FALSE(core::Progress::is_unseen());
  {
    const core::Progress::Unseen unseen;
    EXPECT_TRUE(core::Progress::is_unseen());
  }
  EXPECT_FALSE(core::Progress::is_unseen());
  EXPECT_GT(marks_of_a_heap(Solver::kDantzig, 2), 0U);
  EXPECT_FALSE(core::Progress::is_unseen());
}

}  // namespace
}  // namespace aurasim::physics::testing
