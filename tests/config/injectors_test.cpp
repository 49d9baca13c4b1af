#include <set>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

class Injectors : public testing::Test {
 protected:
  std::vector<core::Injector> read(const std::string& where, const std::string& head = "",
                                   const std::vector<std::string>& overrides = {}) const {
    return workspace_
        .scene(head + "prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1}}\n" +
                   "bodies: [{prototype: ball}]\n" +
                   "injectors:\n  - {name: rain, seed: 5, rate: 10, count: 100, start: 1, prototypes: [ball], " +
                   where + "}\n",
               overrides)
        .injectors;
  }

  static double total_rate(const std::vector<core::Injector>& injectors) {
    double rate = 0;
    for (const auto& i : injectors) rate += i.rate_per_s;
    return rate;
  }
  static std::uint64_t total_bodies(const std::vector<core::Injector>& injectors) {
    std::uint64_t count = 0;
    for (const auto& i : injectors) count += i.max_bodies;
    return count;
  }

  const Workspace workspace_;
};

TEST_F(Injectors, OneVolumeIsOneInjector) {
  const auto found = read("volume: {center: [1, 2, 3], size: [2, 4, 6]}, velocity: {min: [-1, 0, 0], max: [1, 0, 0]}");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "rain");
  EXPECT_EQ(found[0].seed, 5u);
  EXPECT_EQ(value_of(found[0].first_id), 1u) << "after the bodies";
  EXPECT_EQ(found[0].max_bodies, 100u);
  EXPECT_EQ(found[0].rate_per_s, 10);
  EXPECT_EQ(found[0].start_s, 1);
  EXPECT_EQ(found[0].volume_min, core::Vec3(0, 0, 0));
  EXPECT_EQ(found[0].volume_max, core::Vec3(2, 4, 6));
  EXPECT_EQ(found[0].velocity_min, core::Vec3(-1, 0, 0));
}

TEST_F(Injectors, VolumesShareTheBodies) {
  const auto found = read(
      "volumes: [{center: [0, 0, 0], size: [1, 1, 1]}, {center: [9, 0, 0], size: [1, 1, 1]}, {center: [18, 0, 0], "
      "size: [1, 1, 1]}]");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_DOUBLE_EQ(total_rate(found), 10);
  EXPECT_EQ(total_bodies(found), 100u);
  std::set<std::uint64_t> seeds;
  std::uint64_t next_id = 1;
  for (const auto& injector : found) {
    EXPECT_EQ(value_of(injector.first_id), next_id) << "ranges of ids follow each other";
    next_id += injector.max_bodies;
    seeds.insert(injector.seed);
  }
  EXPECT_EQ(seeds.size(), 3u) << "each has its own sequence";
  EXPECT_NEAR(found[1].start_s - found[0].start_s, 0.1, 1e-12) << "they take turns";
}

TEST_F(Injectors, PerBoundaryThereIsOneOnEachSide) {
  const auto found = read("per: {boundaries: {distance: 12, size: [20, 150, 6], height: 15}}", "layout: launch\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].volume_min, core::Vec3(-22, -75, 12));
  EXPECT_EQ(found[0].volume_max, core::Vec3(-2, 75, 18));
  EXPECT_EQ(found[1].volume_min, core::Vec3(2, -75, 12));
}

TEST_F(Injectors, PerRegionThereIsOneInTheMiddle) {
  const auto found = read("per: {regions: {size: [20, 20, 20], height: 15}}", "layout: launch\n", {"regions.count=3"});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].volume_min, core::Vec3(-50, -10, 5));
  EXPECT_EQ(found[2].volume_max, core::Vec3(50, 10, 25));
}

TEST_F(Injectors, EveryRegionGetsTheSameShareHoweverManySidesItHas) {
  const auto found = read("per: {boundaries: {distance: 12, size: [20, 150, 6], height: 15}}",
                          "layout: {layout: columns, count: 3, width: 40}\n");
  ASSERT_EQ(found.size(), 4u);
  EXPECT_NEAR(found[0].rate_per_s, 10 / 3.0, 1e-9);
  EXPECT_NEAR(found[1].rate_per_s, 10 / 6.0, 1e-9);
  EXPECT_DOUBLE_EQ(total_rate(found), 10);
  EXPECT_EQ(total_bodies(found), 100u);
}

TEST_F(Injectors, InAGridTheVolumesLieAlongTheirBoundaries) {
  const auto found = read("per: {boundaries: {distance: 5, size: [2, 30, 4], height: 3}}",
                          "layout: {layout: grid, rows: 2, columns: 2, cell: [40, 40]}\n");
  ASSERT_EQ(found.size(), 8u);
  EXPECT_EQ(found[0].volume_min, core::Vec3(-6, -35, 1)) << "region 0, towards 1: along y";
  EXPECT_EQ(found[1].volume_min, core::Vec3(-35, -6, 1)) << "region 0, towards 2: along x";
}

TEST_F(Injectors, ALayoutOfTheSceneDoesNotFollowTheNodes) {
  const std::string head = "layout: {layout: columns, count: 2, width: 80}\n";
  const std::string where = "per: {regions: {size: [1, 1, 1], height: 15}}";
  EXPECT_EQ(read(where, head, {"regions.count=1"}).size(), 2u);
  EXPECT_EQ(read(where, head, {"regions.count=4"}).size(), 2u);
  EXPECT_EQ(read(where, head, {"regions.count=4", "scene.layout=launch"}).size(), 4u);
}

TEST_F(Injectors, OneRegionHasNoBoundaries) {
  const auto errors = workspace_.errors_of([&] {
    read("per: {boundaries: {distance: 5, size: [2, 30, 4], height: 3}}", "layout: launch\n", {"regions.count=1"});
  });
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0], testing::HasSubstr("injectors[0].per.boundaries: found a layout of one region"));
}

}  // namespace
}  // namespace aurasim::config
