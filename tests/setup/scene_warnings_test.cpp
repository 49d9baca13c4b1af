#include "setup/scene_warnings.h"

#include <algorithm>
#include <chrono>

#include "config/workspace.h"

namespace aurasim::setup {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Scenes of balls of radius 0.5 and bricks of 2 x 1 x 1 on a ground, from line 9 on.
class SceneWarnings : public testing::Test {
 protected:
  std::vector<std::string> warnings(const std::string& rest, const std::vector<std::string>& overrides = {}) {
    workspace_.write("scene.yaml", R"(shapes:
  ball: {sphere: {radius: 0.5}}
  brick: {box: {size: [2, 1, 1]}}
prototypes:
  ball: {shape: ball, mass: 1}
  brick: {shape: brick, mass: 1}
statics:
  - {name: ground, shape: {plane: {}}}
)" + rest);
    return scene_warnings(config::read_launch(workspace_.write("launch.yaml", config::kSmallLaunch), overrides));
  }

  config::Workspace workspace_;
};

TEST_F(SceneWarnings, BodiesThatTouchOrNearlyDoAreNone) {
  EXPECT_THAT(warnings(R"(  - {name: shelf, shape: brick, position: [5, 0, 0.5]}
bodies:
  - {prototype: ball, position: [0, 0, 0.5]}
  - {prototype: ball, position: [0, 0, 1.49]}
  - {prototype: brick, position: [5, 0, 1.5]}
generators:
  - stack: {prototype: brick, count: 5, position: [0, 5, 0]}
)"),
              IsEmpty());
}

TEST_F(SceneWarnings, BodiesThatOverlapAreNamedWithTheirPlace) {
  EXPECT_THAT(warnings(R"(bodies:
  - {prototype: ball, name: first, position: [0, 0, 0.5]}
  - {prototype: brick, position: [1.2, 0, 0.5]}
)"),
              ElementsAre(AllOf(HasSubstr("scene.yaml:10:5: body 0 (\"first\") overlaps body 1 by 0.3 m"))));
}

TEST_F(SceneWarnings, CornersOfBoundingBoxesMayOverlap) {
  EXPECT_THAT(warnings(R"(bodies:
  - {prototype: ball, position: [0, 0, 2]}
  - {prototype: brick, position: [1.3, 0, 1], orientation: {rpy_deg: [0, 45, 0]}}
)"),
              IsEmpty());
}

TEST_F(SceneWarnings, BodiesThatAJointHoldsTogetherMayOverlap) {
  const std::string bodies = R"(bodies:
  - {prototype: ball, name: a, position: [0, 0, 2]}
  - {prototype: ball, name: b, position: [0.5, 0, 2]}
)";
  EXPECT_THAT(warnings(bodies + "joints: [{ball: {}, bodies: [b, a]}]\n"), IsEmpty());
  EXPECT_EQ(warnings(bodies + "joints: [{ball: {}, bodies: [b, a], collide: true}]\n").size(), 1u);
}

TEST_F(SceneWarnings, BodiesInTheGroundOrBelowItAreNamed) {
  EXPECT_THAT(warnings(R"(bodies:
  - {prototype: brick, position: [0, 0, 0.2]}
  - {prototype: ball, position: [5, 0, -3]}
)"),
              ElementsAre(HasSubstr("body 0 is 0.3 m deep in the static \"ground\""),
                          HasSubstr("body 1 is 3.5 m below the surface of the static \"ground\"")));
}

TEST_F(SceneWarnings, BodiesInOtherStaticsAreNamed) {
  EXPECT_THAT(warnings(R"(  - {name: shelf, shape: brick, position: [5, 0, 2]}
bodies:
  - {prototype: ball, position: [5, 0, 2.6]}
)"),
              ElementsAre(HasSubstr("body 0 is 0.4 m deep in the static \"shelf\"")));
}

TEST_F(SceneWarnings, SpeedsAboveTheToleranceAreNamed) {
  const std::string fast = R"(bodies:
  - {prototype: ball, name: bullet, position: [0, 0, 2], velocity: [900, 0, 0]}
injectors:
  - {name: gun, rate: 1, count: 5, prototypes: [ball], volume: {center: [0, 0, 9], size: [1, 1, 1]},
     velocity: {min: [-30, -30, 0], max: [30, 30, 0]}}
)";
  EXPECT_THAT(warnings(fast),
              ElementsAre(HasSubstr("scene.yaml:10:5: body 0 (\"bullet\") starts with 900 m/s, and tolerances.speed is "
                                    "32 m/s"),
                          HasSubstr("scene.yaml:12:5: injector \"gun\" may throw with 42.43 m/s")));
  EXPECT_THAT(warnings(fast, {"tolerances.speed=1000", "regions.count=1"}), IsEmpty());
}

TEST_F(SceneWarnings, ManyOfAKindAreCounted) {
  const auto all = warnings("generators:\n  - row: {prototype: ball, count: 30, step: [2, 0, 0]}\n");
  ASSERT_EQ(all.size(), 11u);
  EXPECT_THAT(all[10], testing::StartsWith("and 20 more"));
}

/// Every brick overlaps every other one: looking at all pairs took 100 s for a quarter of them.
TEST_F(SceneWarnings, AHeapWhoseBodiesAllOverlapIsLookedThroughInNLogN) {
  const std::string heap =
      "generators:\n  - block: {prototype: brick, counts: [100, 20, 20], spacing: [0.002, 0.002, 0.002], position: "
      "[0, 0, 2]}\n";
  const auto begin = std::chrono::steady_clock::now();
  const auto all = warnings(heap);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  ASSERT_EQ(all.size(), 11u);
  EXPECT_THAT(all[0], HasSubstr("scene.yaml:10:12: body 0 overlaps body "));
  EXPECT_THAT(all[10], AllOf(testing::StartsWith("and "), HasSubstr("40000 of 40000 bodies overlap another one")));
}

TEST_F(SceneWarnings, EachBodyThatOverlapsAnotherOneIsNamedBesideALargeOne) {
  const std::string large =
      "  - {prototype: plate, position: [0, 0, 5]}\n  - {prototype: ball, position: [40, 0, 5.3]}\n";
  workspace_.write("scene.yaml", R"(shapes:
  ball: {sphere: {radius: 0.5}}
  plate: {box: {size: [100, 100, 1]}}
prototypes:
  ball: {shape: ball, mass: 1}
  plate: {shape: plate, mass: 1}
bodies:
)" + large + R"(generators:
  - row: {prototype: ball, count: 20, step: [2, 0, 0], position: [-20, 0, 6.01]}
  - row: {prototype: ball, count: 3, step: [2, 0, 0], position: [-20, 9, 5.8]}
)");
  const auto all =
      scene_warnings(config::read_launch(workspace_.write("launch.yaml", "scene: scene.yaml\nregions: {count: 1}\n")));
  ASSERT_EQ(all.size(), 4u);
  EXPECT_THAT(all[0], HasSubstr("body 0 overlaps body "));
  std::string text;
  for (const std::string& line : all) text += line + "\n";
  for (const char* name : {"body 1 ", "body 22 ", "body 23 ", "body 24 "}) EXPECT_THAT(text, HasSubstr(name));
}

TEST_F(SceneWarnings, HowFarTheyAreIsSaid) {
  std::vector<double> said;
  workspace_.write("scene.yaml",
                   "shapes: {ball: {sphere: {radius: 0.5}}}\nprototypes: {ball: {shape: ball, mass: 1}}\n"
                   "generators: [{row: {prototype: ball, count: 1000, step: [2, 0, 0]}}]\n");
  scene_warnings(config::read_launch(workspace_.write("launch.yaml", config::kSmallLaunch)),
                 [&said](double share) { said.push_back(share); });
  ASSERT_GT(said.size(), 10u);
  EXPECT_TRUE(std::ranges::is_sorted(said));
  EXPECT_LE(said.back(), 1);
}

TEST_F(SceneWarnings, BodiesOfGeneratorsHaveThePlaceOfTheGenerator) {
  EXPECT_THAT(warnings("generators:\n  - row: {prototype: ball, count: 2, step: [0.5, 0, 0], position: [0, 0, 2], "
                       "name: row}\n"),
              ElementsAre(HasSubstr("scene.yaml:10:10: body 0 (\"row.0\") overlaps body 1 (\"row.1\") by 0.5 m")));
}

TEST_F(SceneWarnings, ShippedScenesHaveNone) {
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(AURASIM_SOURCE_DIR) / "launch_configs")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_THAT(scene_warnings(config::read_launch(entry.path())), IsEmpty()) << entry.path();
  }
}

}  // namespace
}  // namespace aurasim::setup
