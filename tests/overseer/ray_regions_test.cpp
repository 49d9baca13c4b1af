// Who is asked what a ray meets.
#include "overseer/ray_regions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::overseer {
namespace {

using core::RegionId;
using ::testing::ElementsAre;

/// Four cells of 10 m that meet in the origin: 0 and 1 below the x axis, 2 and 3 above it.
class RayRegions : public ::testing::Test {
 protected:
  RayRegions() {
    scene_.shapes.push_back({"ball", core::Sphere{0.5}});
    scene_.prototypes.emplace_back();
  }
  void place(std::uint64_t id, std::uint32_t host, const core::Vec3& p) {
    core::ReplicaBody body;
    body.id = core::BodyId{id};
    body.host = RegionId{host};
    body.p_WB = p;
    published_[host].push_back(body);
  }
  std::vector<RegionId> asked(const core::Vec3& from, const core::Vec3& to, double margin_m = 0.1) {
    WorldView view{{.region_count = 4, .unclaimed_patience = 30, .wait_s = 0.3}};
    for (std::uint32_t r = 0; r < 4; ++r) {
      view.set_region(RegionId{r}, WorldView::RegionState::kLive);
      core::Replica replica;
      replica.source = RegionId{r};
      replica.stamp = 3;
      replica.sequence = 1;
      replica.bodies = published_[r];
      view.accept(std::move(replica), 0);
    }
    while (view.compose(0) != nullptr) {
    }
    return regions_for_ray({from, to}, core::RegionMap::grid(2, 2, 10, 10), view, scene_, margin_m);
  }

  core::Scene scene_;
  std::array<std::vector<core::ReplicaBody>, 4> published_;
};

TEST_F(RayRegions, AreThoseThatItCrosses) {
  EXPECT_THAT(asked({-5, -5, 9}, {-5, -5, 0}), ElementsAre(RegionId{0}));
  EXPECT_THAT(asked({-5, -5, 9}, {5, -5, 0}), ElementsAre(RegionId{0}, RegionId{1}));
  EXPECT_THAT(asked({-5, -4, 9}, {4, 5, 0}), ElementsAre(RegionId{0}, RegionId{2}, RegionId{3}));
  EXPECT_EQ(asked({-5, -5, 9}, {5, 5, 0}).size(), 4U) << "through the corner";
}

TEST_F(RayRegions, NearABorderBothAreAsked) {
  EXPECT_THAT(asked({-0.3, -5, 9}, {-0.3, -5, 0}), ElementsAre(RegionId{0}));
  EXPECT_THAT(asked({-0.3, -5, 9}, {-0.3, -5, 0}, 0.5), ElementsAre(RegionId{0}, RegionId{1}));
}

TEST_F(RayRegions, AHostOfABodyOnTheWayIsAskedWhereverItsRegionIs) {
  place(7, 3, {-5, -5, 4});
  place(8, 2, {-5, -8, 4});
  EXPECT_THAT(asked({-5, -5, 9}, {-5, -5, 0}), ElementsAre(RegionId{0}, RegionId{3}));
  EXPECT_THAT(asked({-5, -5, 9}, {-5, -5, 6}), ElementsAre(RegionId{0})) << "it ends before the body";
}

}  // namespace
}  // namespace aurasim::overseer
