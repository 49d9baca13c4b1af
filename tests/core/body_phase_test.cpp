// The state machine of thesis 4.4: one test for each transition that there is, and none other.
#include "core/body_phase.h"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace aurasim::core::testing {
namespace {

struct Transition {
  std::string name;
  Phase from;
  PhaseEvent event;
  Phase to;
};

using enum PhaseEvent;

const std::vector<Transition> kTransitions = {
    {"ANewBodyInsideIsTheHostsAlone", Phase::kInjected, kFarFromBoundary, Phase::kHostRegion},
    {"ANewBodyInAZoneProjects", Phase::kInjected, kNearBoundary, Phase::kIntersectingBoundary},
    {"ANewBodyOutsideProjects", Phase::kInjected, kOutside, Phase::kBoundaryTraversed},

    {"ABodyInsideStays", Phase::kHostRegion, kFarFromBoundary, Phase::kHostRegion},
    {"ABodyInsideEntersAZone", Phase::kHostRegion, kNearBoundary, Phase::kIntersectingBoundary},
    {"AFastBodyCrossesTheZoneInOneStep", Phase::kHostRegion, kOutside, Phase::kBoundaryTraversed},
    {"ABodyInsideIsPulledWithItsCluster", Phase::kHostRegion, kAuraHit, Phase::kSent},

    {"ABodyInAZoneTurnsBack", Phase::kIntersectingBoundary, kFarFromBoundary, Phase::kHostRegion},
    {"ABodyInAZoneStays", Phase::kIntersectingBoundary, kNearBoundary, Phase::kIntersectingBoundary},
    {"ABodyInAZoneLeavesItsRegion", Phase::kIntersectingBoundary, kOutside, Phase::kBoundaryTraversed},
    {"ABodyInAZoneIsHit", Phase::kIntersectingBoundary, kAuraHit, Phase::kSent},

    {"ABodyOutsideIsBackInsideInOneStep", Phase::kBoundaryTraversed, kFarFromBoundary, Phase::kHostRegion},
    {"ABodyOutsideComesBack", Phase::kBoundaryTraversed, kNearBoundary, Phase::kIntersectingBoundary},
    {"ABodyOutsideStaysOutside", Phase::kBoundaryTraversed, kOutside, Phase::kBoundaryTraversed},
    {"ABodyOutsideIsHit", Phase::kBoundaryTraversed, kAuraHit, Phase::kSent},
    {"ABodyOutsideGoesHome", Phase::kBoundaryTraversed, kIsland, Phase::kSent},
};

class PhaseTransition : public ::testing::TestWithParam<Transition> {};

TEST_P(PhaseTransition, Happens) { EXPECT_EQ(next_phase(GetParam().from, GetParam().event), GetParam().to); }

INSTANTIATE_TEST_SUITE_P(Table, PhaseTransition, ::testing::ValuesIn(kTransitions),
                         [](const auto& info) { return info.param.name; });

TEST(BodyPhase, HasNoOtherTransition) {
  std::map<std::pair<Phase, PhaseEvent>, Phase> allowed;
  for (const Transition& t : kTransitions) allowed.emplace(std::pair(t.from, t.event), t.to);
  ASSERT_EQ(allowed.size(), kTransitions.size());
  int forbidden = 0;
  for (int p = 0; p < kPhases; ++p) {
    for (int e = 0; e < kPhaseEvents; ++e) {
      const auto phase = static_cast<Phase>(p);
      const auto event = static_cast<PhaseEvent>(e);
      if (allowed.contains({phase, event})) continue;
      EXPECT_EQ(next_phase(phase, event), std::nullopt) << "phase " << p << ", event " << e;
      ++forbidden;
    }
  }
  EXPECT_EQ(forbidden, kPhases * kPhaseEvents - 16);
}

TEST(BodyPhase, OnlyBodiesAtABoundaryProject) {
  EXPECT_FALSE(projects(Phase::kInjected));
  EXPECT_FALSE(projects(Phase::kHostRegion));
  EXPECT_TRUE(projects(Phase::kIntersectingBoundary));
  EXPECT_TRUE(projects(Phase::kBoundaryTraversed));
  EXPECT_FALSE(projects(Phase::kSent));
}

}  // namespace
}  // namespace aurasim::core::testing
