// Each kind of body on each kind of floor that is made of pieces: inner edges do not brake it (physics/inner_edges.h).
#include <algorithm>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "physics/static_floors.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

struct Slid {
  Vec3 way = Vec3::Zero();  ///< m
  double high_m = 0;        ///< greatest height above the floor
};

/// Where a body starts, and its velocity. All ways are over the joints of tiles, or along one.
struct Way {
  std::string name;
  Vec3 start, v;
};

std::vector<Way> ways() {
  return {{"Across", {0.13, 0.21, 0}, {8, 0, 0}},
          {"AlongAJoint", {0.13, 0, 0}, {8, 0, 0}},
          {"Back", {15.13, 0.21, 0}, {-8, 0, 0}},
          {"Slanting", {0.13, -1.9, 0}, {7.7, 2, 0}}};
}

/// Two seconds.
Slid slide(const Slider& slider, const Settings& settings, const Floor& floor, const Way& way) {
  core::Scene scene = scene_of_slider(slider.shape);
  floor.add(scene);
  RegionWorld world(scene, settings);
  const Vec3 start = way.start + Vec3(0, 0, slider.height_m);
  world.add(std::vector{record_of(slider, start, way.v)});
  Slid result;
  for (int i = 0; i < 120; ++i) {
    world.step();
    result.high_m = std::max(result.high_m, world.records()[0].p_WB.z() - start.z());
  }
  result.way = world.records()[0].p_WB - start;
  return result;
}

void expect_as_on_one_floor(const Slider& slider, const Settings& settings, const Floor& floor, const Way& way) {
  const Slid one = slide(slider, settings, kOneFloor, way), pieces = slide(slider, settings, floor, way);
  const double far_m = one.way.head<2>().norm();
  EXPECT_NEAR(pieces.way.head<2>().norm(), far_m, 0.01 * far_m) << way.name;
  EXPECT_LT((pieces.way - one.way).head<2>().norm(), 0.025 * far_m) << way.name << ": it turns aside";
  EXPECT_LT(pieces.high_m, 0.025) << way.name;  // trips lift it by 0.03 m and more
}

class InnerEdgesOf : public ::testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {
 protected:
  const Floor& floor() const {
    static const std::vector<Floor> floors = floors_of_pieces();
    return floors[std::get<0>(GetParam())];
  }
  const Slider& slider() const {
    static const std::vector<Slider> all = sliders();
    return all[std::get<1>(GetParam())];
  }
};

TEST_P(InnerEdgesOf, BrakeNobody) {
  for (const Way& way : ways()) expect_as_on_one_floor(slider(), balanced(), floor(), way);
}

TEST_P(InnerEdgesOf, BrakeNobodyWithBulletsSolver) {
  expect_as_on_one_floor(slider(), exact(), floor(), ways().front());
}

INSTANTIATE_TEST_SUITE_P(Floors, InnerEdgesOf,
                         ::testing::Combine(::testing::Range<std::size_t>(0, floors_of_pieces().size()),
                                            ::testing::Range<std::size_t>(0, sliders().size())),
                         [](const auto& param) {
                           return floors_of_pieces()[std::get<0>(param.param)].name + "Below" +
                                  sliders()[std::get<1>(param.param)].name;
                         });

}  // namespace
}  // namespace aurasim::physics::testing
