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
  double way_m = 0;   ///< along x
  double high_m = 0;  ///< greatest height above the floor
};

/// Two seconds, from 8 m/s along x.
Slid slide(const Slider& slider, const Settings& settings, const Floor& floor) {
  core::Scene scene = scene_of_slider(slider.shape);
  floor.add(scene);
  RegionWorld world(scene, settings);
  const Vec3 start(0.13, 0.21, slider.height_m);
  world.add(std::vector{record_of(slider, start, {8, 0, 0})});
  Slid result;
  for (int i = 0; i < 120; ++i) {
    world.step();
    result.high_m = std::max(result.high_m, world.records()[0].p_WB.z() - start.z());
  }
  result.way_m = world.records()[0].p_WB.x() - start.x();
  return result;
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
  const Slid one = slide(slider(), balanced(), kOneFloor), pieces = slide(slider(), balanced(), floor());
  EXPECT_NEAR(pieces.way_m, one.way_m, 0.01 * one.way_m);
  EXPECT_LT(pieces.high_m, 0.025);  // trips lift it by 0.08 m and more
}

TEST_P(InnerEdgesOf, BrakeNobodyWithBulletsSolver) {
  const Slid one = slide(slider(), exact(), kOneFloor), pieces = slide(slider(), exact(), floor());
  EXPECT_NEAR(pieces.way_m, one.way_m, 0.01 * one.way_m);
  EXPECT_LT(pieces.high_m, 0.025);  // trips lift it by 0.08 m and more
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
