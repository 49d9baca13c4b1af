// Whose bodies may come to a region that does not listen to their host is introduced in time.
#include "core/introductions.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/make_aura.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Step kIntroduced = 100;

/// Four columns of 10 m around the origin; we are the second, from -10 to 0, and hear the two beside us.
class TheOwnerOfAPlace : public ::testing::Test {
 protected:
  void add(RegionId host, double x, double v_x, double v_z = 0) {
    AuraRecord aura;
    aura.id = BodyId{next_id_++};
    aura.host = host;
    aura.prototype = ball_;
    aura.stamp = kIntroduced - 1;
    aura.pose.p_WB = {x, 0, 0};
    aura.v_WB = {v_x, 0, v_z};
    aura.speed_m_s = aura.v_WB.norm() + 0.1;
    bodies_.add(aura, kIntroduced - 1, kIntroduced, *aura_);
  }
  const std::vector<Introduction>& look() {
    bodies_.build();
    return introducer_.look(bodies_, 1);
  }

  RoundShapes shapes_;
  PrototypeId ball_ = shapes_.sphere(0.3);
  RegionMap map_ = RegionMap::columns(4, 10);
  Vicinity vicinity_{map_, RegionId{1}, 0};
  std::unique_ptr<const Aura> aura_ = make_aura(AuraRules{}, shapes_);
  Introducer introducer_{*aura_, vicinity_};
  ForeignBodies bodies_;
  std::uint64_t next_id_ = 1;
};

TEST_F(TheOwnerOfAPlace, IntroducesAGuestsHostToWhereItGoes) {
  add(RegionId{0}, -1, 1);
  EXPECT_THAT(look(), ElementsAre(Introduction{RegionId{0}, RegionId{2}}));
}

TEST_F(TheOwnerOfAPlace, LeavesAloneWhoStaysAtHome) {
  add(RegionId{0}, -15, 1);
  add(RegionId{2}, 5, 1);
  EXPECT_THAT(look(), IsEmpty());
}

TEST_F(TheOwnerOfAPlace, IntroducesTwoHostsWhoseBodiesAreItsGuests) {
  add(RegionId{0}, -8, 0);
  add(RegionId{2}, -2, 0);
  EXPECT_THAT(look(), ElementsAre(Introduction{RegionId{0}, RegionId{2}}));
}

TEST_F(TheOwnerOfAPlace, IntroducesTwoHostsWhoseBodiesMayMeetInIt) {
  add(RegionId{0}, -10.2, 6);
  EXPECT_THAT(look(), IsEmpty());
  add(RegionId{2}, 0.2, -6);
  EXPECT_THAT(look(), ElementsAre(Introduction{RegionId{0}, RegionId{2}}));
}

TEST_F(TheOwnerOfAPlace, LeavesTwoHostsAloneWhoseBodiesAreBesideIt) {
  add(RegionId{0}, -10.2, 0);
  add(RegionId{2}, 0.2, 0);
  EXPECT_THAT(look(), IsEmpty());
}

/// Both listen to each other only as long as somebody introduces them.
TEST_F(TheOwnerOfAPlace, IntroducesItselfToTheHostOfAGuest) {
  vicinity_.listen_to(RegionId{3});
  add(RegionId{3}, -3, 0);
  EXPECT_THAT(look(), Contains(Introduction{RegionId{1}, RegionId{3}}));
}

/// Where states are checked a body is believed to fall straight.
TEST_F(TheOwnerOfAPlace, LooksAcrossAndNotDown) {
  add(RegionId{0}, -10.5, 0, -12);
  add(RegionId{2}, 0.2, 0);
  EXPECT_THAT(look(), ElementsAre(Introduction{RegionId{0}, RegionId{2}}));
  AuraRules checked;
  checked.redo = true;
  checked.uncertainty = 0.1;
  aura_ = make_aura(checked, shapes_);
  Introducer introducer(*aura_, vicinity_);
  EXPECT_THAT(introducer.look(bodies_, 1), IsEmpty());
}

TEST_F(TheOwnerOfAPlace, IntroducesNobodyWhomItDoesNotHear) {
  add(RegionId{2}, 9.5, 2);  // the owner of that place is region 2 itself, which is near region 3
  EXPECT_THAT(look(), IsEmpty());
  add(RegionId{0}, 9.5, 2);
  EXPECT_THAT(look(), ElementsAre(Introduction{RegionId{0}, RegionId{2}})) << "region 3 does not hear us";
}

TEST(TheStart, RelatesWhoHostsFarFromHome) {
  RoundShapes shapes;
  Snapshot scene;
  for (const double x : {-15.0, 15.0}) {
    BodyState& body = scene.bodies.emplace_back();
    body.id = BodyId{scene.bodies.size()};
    body.prototype = PrototypeId{0};
    body.pose.p_WB = {x, 0, 0};
  }
  shapes.sphere(0.3);
  const auto aura = make_aura(AuraRules{}, shapes);
  const RegionMap map = RegionMap::columns(4, 10);
  const std::vector<RegionId> hosts = {RegionId{0}, RegionId{0}};  // a chain from end to end
  EXPECT_THAT(related_at_start(*aura, map, 0, RegionId{3}, scene, hosts), ElementsAre(RegionId{0}));
  EXPECT_THAT(related_at_start(*aura, map, 0, RegionId{0}, scene, hosts), ElementsAre(RegionId{3}));
  EXPECT_THAT(related_at_start(*aura, map, 0, RegionId{1}, scene, hosts), IsEmpty());
}

}  // namespace
}  // namespace aurasim::core::testing
