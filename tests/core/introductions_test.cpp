// Whose bodies may come to a region that does not listen to their host is introduced in time.
#include "core/introductions.h"

#include <memory>
#include <optional>
#include <random>
#include <utility>

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
  AuraRecord aura_at(RegionId host, double x, double v_x, double v_z = 0) {
    AuraRecord aura;
    aura.id = BodyId{next_id_++};
    aura.host = host;
    aura.prototype = ball_;
    aura.stamp = kIntroduced - 1;
    aura.pose.p_WB = {x, 0, 0};
    aura.v_WB = {v_x, 0, v_z};
    aura.speed_m_s = aura.v_WB.norm() + 0.1;
    return aura;
  }
  void add(RegionId host, double x, double v_x, double v_z = 0) {
    bodies_.add(aura_at(host, x, v_x, v_z), kIntroduced - 1, kIntroduced, *aura_);
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

/// Each of two bodies that may come together has a reach of its own, however fast a third one is.
TEST_F(TheOwnerOfAPlace, LooksAtTheSpeedsOfTheTwoBodies) {
  for (const bool checked : {false, true}) {
    AuraRules rules;
    rules.redo = checked;
    aura_ = make_aura(rules, shapes_);
    Introducer introducer(*aura_, vicinity_);
    bodies_ = {};
    add(RegionId{0}, -10.5, 0);
    add(RegionId{2}, 0.5, 0);
    bodies_.build();
    EXPECT_THAT(introducer.look(bodies_, 40), IsEmpty());
    add(RegionId{0}, -9, 12);
    bodies_.build();
    EXPECT_THAT(introducer.look(bodies_, 40), ElementsAre(Introduction{RegionId{0}, RegionId{2}}));
  }
}

/// Two bodies that come together in our territory, each at its own speed. Their hosts listen to each other in the state
/// of the last aura that can tell either host in time that the two have to share a host.
TEST_F(TheOwnerOfAPlace, IntroducesTwoHostsInTimeForTheirBodiesToMeet) {
  constexpr int kCollision = 200;
  std::mt19937_64 random(1);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (int trial = 0; trial < 200; ++trial) {
    AuraRules rules;
    rules.redo = trial % 2 == 0;
    rules.lookahead = 1 + trial % 4;
    rules.uncertainty = trial % 3 == 0 ? 0.5 : 0;  // 0: there is no reserve
    aura_ = make_aura(rules, shapes_);
    Introducer introducer(*aura_, vicinity_);
    const double x = between(-9.5, -0.5), v_a = between(0.1, 15), v_b = -between(0.1, 15);
    const auto add_both = [&](int state) {
      bodies_ = {};
      const double left_s = (kCollision - state) / 60.0;
      const Step stamp = kIntroduced + state - rules.lookahead;
      for (const auto& [host, v] : {std::pair(RegionId{0}, v_a), std::pair(RegionId{2}, v_b)}) {
        AuraRecord aura = aura_at(host, x - v * (left_s + rules.lookahead / 60.0), v);
        aura.stamp = stamp;
        bodies_.add(aura, stamp, kIntroduced + state, *aura_);
      }
      bodies_.build();
    };
    std::optional<int> introduced, met;
    for (int state = 0; state < kCollision && !met; ++state) {
      add_both(state);
      if (!introduced && !introducer.look(bodies_, 0).empty()) introduced = state;
      Path own = bodies_[1].path;  // of its host, which knows the present state
      own.pose.p_WB.x() += own.v_WB.x() * own.age_steps / 60;
      own.age_steps = 0;
      if (aura_->meets(bodies_[0].path, own, rules.most_hops())) met = state;
    }
    ASSERT_TRUE(introduced && met) << "trial " << trial;
    const int listening = *introduced + static_cast<int>(horizon::introduction(rules.lookahead));
    EXPECT_LE(listening + rules.lookahead, *met) << "trial " << trial << ", K " << rules.lookahead;
  }
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
