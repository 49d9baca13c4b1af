// When bodies of other regions go home.
#include <memory>
#include <vector>

#include "core/cluster.h"
#include "core/horizon.h"
#include "core/make_aura.h"
#include "core/protocol_fixture.h"

namespace aurasim::core::testing {
namespace {

/// Region 0 gets a ball of region 1, over whose ground it is.
class Arrival : public ProtocolTest {
 protected:
  void arrive(HandOffReason reason) {
    start(0);
    receive_batch_of_1();
    HandOff h = hand_off(1, 0, 0, {record_of(7, 1)});
    h.reason = reason;
    receive(std::move(h), 1);
    host(7, Vec3(20, 0, 0)).epoch = 1;
  }
  void pass_steps_until(Step last) {
    while (now < last && !snapshot.bodies.empty()) pass_step();
  }
  bool is_here() const { return !snapshot.bodies.empty(); }

  Step island() const { return horizon::homecoming(settings.aura.lookahead, settings.aura.redo) + 1; }
};

TEST_F(Arrival, GoesHomeAsSoonAsItIsAnIsland) {
  for (const bool checked : {false, true}) {
    for (const HandOffReason why : {HandOffReason::kBoundaryTraversal, HandOffReason::kAuraCollision}) {
      SCOPED_TRACE(checked);
      settings.aura.redo = checked;
      snapshot = {};
      now = 0;
      arrive(why);
      pass_steps_until(island() - 1);
      EXPECT_TRUE(is_here());
      pass_steps_until(island());
      EXPECT_FALSE(is_here());
    }
  }
}

/// The guest touches a ball of our region for a while, so it begins to be an island anew.
TEST_F(Arrival, GoesHomeAfterItHasBeenAnIslandWithoutABreak) {
  for (const bool checked : {false, true}) {
    SCOPED_TRACE(checked);
    settings.aura.redo = checked;
    snapshot = {};
    now = 0;
    arrive(HandOffReason::kBoundaryTraversal);
    host(9, Vec3(-20, 0, 0));
    const Step touches = island() - 1;
    pass_steps_until(touches - 1);
    snapshot.contacts = {{0, 1}};
    pass_steps_until(touches);
    snapshot.contacts.clear();
    while (now < 3 * island() && snapshot.bodies.size() == 2) pass_step();
    EXPECT_EQ(now, touches + island());
  }
}

/// A ball comes up from behind that stays, because it is connected with one of our region. The way home looks a hop
/// further than clusters.
TEST_F(Arrival, GoesHomeOnlyIfNobodyWhoStaysMayMeetItSoon) {
  const std::unique_ptr<const Aura> aura = make_aura(settings.aura, shapes);
  int in_between = 0;
  for (double gap_m = 0.1; gap_m < 6; gap_m += 0.1) {
    SCOPED_TRACE(gap_m);
    snapshot = {};
    now = 0;
    arrive(HandOffReason::kBoundaryTraversal);
    HandOff h = hand_off(1, 0, 0, {record_of(8, 1)});
    receive(std::move(h), 2);
    host(8, Vec3(19 - gap_m, 0, 0), Vec3(6, 0, 0)).epoch = 1;
    host(9, Vec3(-20, 0, 0));
    std::vector<Path> paths;
    for (const BodyState& each : snapshot.bodies) {
      paths.push_back(path_of(each, 0, shapes));
      paths.back().speed_m_s = aura->speed_of(each);
    }
    Clusters clusters(*aura);
    const std::vector<std::uint8_t> hops(paths.size(), 1);
    clusters.begin(paths, hops, {}, {});
    clusters.complete(0);
    const bool one_cluster = clusters.of(0) == clusters.of(1);
    const bool meets_soon = clusters.any_near(0, horizon::kHomewardHops, [](std::uint32_t) { return true; });
    in_between += meets_soon ? 1 : 0;
    while (now < 3 * island()) {
      const auto last = static_cast<std::uint32_t>(snapshot.bodies.size() - 1);
      snapshot.contacts = {{last - 1, last}};
      pass_step();
    }
    EXPECT_EQ(snapshot.bodies.size() == 3, one_cluster || meets_soon);
  }
  EXPECT_GT(in_between, 0);
}

/// A heap that something falls on all the time stays where it is, however large it is and wherever it lies. If it went
/// home, it would be pulled back.
TEST_F(ProtocolTest, AHeapThatIsTouchedAllTheTimeStaysOnItsHost) {
  constexpr std::uint32_t kSide = 17;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    host(i, Vec3(20 + 0.9 * (i % kSide), 0.9 * (i / kSide), 0));  // over region 1
    if (i > 0) snapshot.contacts.push_back({i - 1, i});
  }
  start(0);
  while (now < 300) {
    receive_batch_of_1({foreign(10'000, Vec3(20, -0.95, 0))});
    receive_next();
    ASSERT_TRUE(observe().empty()) << "in state " << now;
  }
}

}  // namespace
}  // namespace aurasim::core::testing
