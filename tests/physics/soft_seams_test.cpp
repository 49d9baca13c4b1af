// The groups of contacts of the soft step (soft/seams.h).
#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "physics/scenes.h"
#include "physics/soft/seams.h"

namespace aurasim::physics::testing {
namespace {

using core::Block;
using core::Vec3;

constexpr int kSeeds = 200, kBodies = 60;

struct Ball {
  Vec3 p;
  Block block;
  double radius_m = 0;
};

struct Touch {
  std::size_t a, b;
};

/// Name of a group in a phase, worked out from the blocks alone: the pair of blocks, or the lowest of four blocks.
using Group = std::tuple<Block, Block>;

/// Balls near edges and corners of blocks, with every block that their state may have.
class Placement {
 public:
  Placement(int seed, double largest_share) : random_(static_cast<std::uint64_t>(seed)) {
    side_m = std::exp(uniform(random_, std::log(1), std::log(100)));
    for (int i = 0; i < kBodies; ++i) balls.push_back(random_ball(largest_share * side_m));
    for (std::size_t a = 0; a < balls.size(); ++a) {
      for (std::size_t b = a + 1; b < balls.size(); ++b) {
        if (touch(balls[a], balls[b])) touches.push_back({a, b});
      }
    }
  }

  /// `shrunk`: share of each radius that is named.
  SoftPlace place(std::size_t i, double shrunk = 1) const {
    return soft_place(balls[i].p, balls[i].block, shrunk * balls[i].radius_m, side_m);
  }

  double side_m;
  std::vector<Ball> balls;
  std::vector<Touch> touches;

 private:
  Ball random_ball(double largest_m) {
    const auto near_a_line = [this] {
      return side_m * (random_() % 4 == 0 ? uniform(random_, -1, 1) : uniform(random_, -0.2, 0.2));
    };
    Ball ball;
    ball.p = {near_a_line(), near_a_line(), uniform(random_, 0, 0.1) * side_m};
    ball.radius_m = largest_m * uniform(random_, 0, 1);
    // a point within the margin may belong to either side
    const double margin = core::kBlockMargin * side_m;
    const Vec3 aside(uniform(random_, -margin, margin), uniform(random_, -margin, margin), 0);
    ball.block = core::block_at(ball.p + aside, side_m);
    return ball;
  }

  bool touch(const Ball& a, const Ball& b) {
    const double gap = 0.0119 * side_m;
    return (a.p - b.p).norm() <= a.radius_m + b.radius_m + gap;
  }

  std::mt19937_64 random_;
};

Group group_of(SoftPhase phase, const Ball& a, const Ball& b, const SoftPlace& place) {
  if (phase != SoftPhase::kCorners) return std::minmax(a.block, b.block);
  const Block& c = place.corner;
  for (const Block& block : {a.block, b.block}) {
    EXPECT_TRUE((block.x == c.x || block.x == c.x - 1) && (block.y == c.y || block.y == c.y - 1));
  }
  return {c, c};
}

/// Number of bodies that are in two groups of a phase, where phase_of_touch(touch) is the phase of a touch.
template <class PhaseOf>
int bodies_in_two_groups(const Placement& placement, PhaseOf&& phase_of_touch) {
  std::map<std::pair<SoftPhase, std::size_t>, std::set<Group>> groups;
  for (const Touch& touch : placement.touches) {
    const SoftPhase phase = phase_of_touch(touch);
    if (phase == SoftPhase::kGiants) continue;  // they are one group
    const Group group = group_of(phase, placement.balls[touch.a], placement.balls[touch.b], placement.place(touch.a));
    for (const std::size_t body : {touch.a, touch.b}) groups[{phase, body}].insert(group);
  }
  return static_cast<int>(std::ranges::count_if(groups, [](const auto& of) { return of.second.size() > 1; }));
}

TEST(SoftSeams, NoBodyIsInTwoGroupsOfAPhase) {
  std::map<SoftPhase, int> seen;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Placement placement(seed, seed % 2 == 0 ? 0.1 : 0.4);
    const auto phase = [&](const Touch& touch) {
      const SoftPhase of = phase_of(placement.place(touch.a), placement.place(touch.b));
      ++seen[of];
      return of;
    };
    EXPECT_EQ(bodies_in_two_groups(placement, phase), 0) << "seed " << seed;
  }
  for (const SoftPhase phase : {SoftPhase::kInside, SoftPhase::kEdges, SoftPhase::kCorners, SoftPhase::kGiants}) {
    EXPECT_GT(seen[phase], 1000) << static_cast<int>(phase);
  }
}

TEST(SoftSeams, WithoutCornersSomeBodiesWouldBeInTwoGroups) {
  int twice = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Placement placement(seed, 0.1);
    twice += bodies_in_two_groups(placement, [&](const Touch& touch) {
      return placement.balls[touch.a].block == placement.balls[touch.b].block ? SoftPhase::kInside : SoftPhase::kEdges;
    });
  }
  EXPECT_GT(twice, 100);
}

/// Number of touches in the giants' phase, with radii up to a share of the side that are named smaller than they are.
int touches_of_giants(double largest_share, double shrunk) {
  int touches = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Placement placement(seed, largest_share);
    for (const Touch& touch : placement.touches) {
      const SoftPhase phase = phase_of(placement.place(touch.a, shrunk), placement.place(touch.b, shrunk));
      if (phase == SoftPhase::kGiants) ++touches;
    }
  }
  return touches;
}

TEST(SoftSeams, TouchesOfBodiesThatAreNoGiantsAreInsideOrOnAnEdgeOrACorner) {
  EXPECT_EQ(touches_of_giants(core::kBlockRadius, 1), 0);
  // larger bodies, if they did not count as giants, would touch beyond their edge and corner
  EXPECT_GT(touches_of_giants(3 * core::kBlockRadius, 1.0 / 3), 0);
}

TEST(SoftSeams, ABodyIsAGiantByItsSizeOrBecauseItIsFarFromTheBlockOfItsMechanism) {
  constexpr double kSide = 16;
  EXPECT_FALSE(soft_place({8, 8, 0}, {0, 0}, 1.77, kSide).is_giant);
  EXPECT_TRUE(soft_place({8, 8, 0}, {0, 0}, 1.78, kSide).is_giant);
  EXPECT_FALSE(soft_place({-0.5, 8, 0}, {0, 0}, 1.77, kSide).is_giant);
  EXPECT_FALSE(soft_place({17.8, 8, 0}, {0, 0}, 0.4, kSide).is_giant);
  EXPECT_TRUE(soft_place({17.9, 8, 0}, {0, 0}, 0.4, kSide).is_giant);
}

}  // namespace
}  // namespace aurasim::physics::testing
