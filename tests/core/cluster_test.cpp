// Clusters against the plainest definition: unite whatever is connected or linked, until nothing more is.
#include "core/cluster.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "core/make_aura.h"
#include "core/random.h"
#include "core/round_shapes.h"

namespace aurasim::core::testing {
namespace {

class ClusterTest : public ::testing::Test {
 protected:
  std::uint32_t place(const Vec3& p, const Vec3& v = Vec3::Zero()) { return place(ball, p, v); }
  std::uint32_t place(PrototypeId kind, const Vec3& p, const Vec3& v) {
    BodyState state;
    state.prototype = kind;
    state.pose.p_WB = p;
    state.v_WB = v;
    paths.push_back(path_of(state, 0, shapes));
    paths.back().speed_m_s = aura().speed_of(state);
    hops.push_back(1);
    return static_cast<std::uint32_t>(paths.size() - 1);
  }
  void contact(std::uint32_t a, std::uint32_t b) { contacts.push_back({std::min(a, b), std::max(a, b)}); }
  void joint(std::uint32_t a, std::uint32_t b) { joints.push_back({std::min(a, b), std::max(a, b)}); }

  const Aura& aura() {
    if (!aura_) aura_ = make_aura(rules, shapes);
    return *aura_;
  }
  Clusters& begin() {
    clusters.emplace(aura());
    clusters->begin(paths, hops, contacts, joints);
    return *clusters;
  }
  Clusters& complete_all() {
    begin();
    for (std::uint32_t i = 0; i < paths.size(); ++i) clusters->complete(i);
    return *clusters;
  }
  bool together(std::uint32_t a, std::uint32_t b) const { return clusters->of(a) == clusters->of(b); }

  /// Cluster number of each body, the smallest index in it.
  std::vector<std::uint32_t> by_definition() {
    std::vector<std::uint32_t> of(paths.size());
    std::iota(of.begin(), of.end(), 0u);
    const auto unite = [&](std::uint32_t a, std::uint32_t b) {
      const auto [to, from] = std::minmax({of[a], of[b]});
      std::replace(of.begin(), of.end(), from, to);
    };
    for (const Contact& c : contacts) unite(c.a, c.b);
    for (const Contact& j : joints) unite(j.a, j.b);
    for (std::uint32_t a = 0; a < paths.size(); ++a) {
      for (std::uint32_t b = 0; b < a; ++b) {
        if (of[a] != of[b] && aura().linked(paths[a], paths[b], 1)) unite(a, b);
      }
    }
    return of;
  }

  void place_random_scene(Random& random) {
    const std::array kinds = {ball, big};
    paths.clear(), hops.clear(), contacts.clear(), joints.clear();
    const std::uint32_t count = 2 + random.below(60);
    const double box = random.between(3, 12);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double speed = random.chance(0.2) ? 25 : random.chance(0.5) ? 3 : 0.3;
      place(kinds[random.chance(0.1)], random.in_box(box), speed * random.direction());
    }
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
      if (random.chance(0.1)) contact(i, i + 1);
      if (random.chance(0.05)) joint(i, random.below(count));
    }
    std::erase_if(joints, [](const Contact& j) { return j.a == j.b; });
  }

  AuraRules rules;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.4);
  PrototypeId big = shapes.sphere(3);
  std::vector<Path> paths;
  std::vector<std::uint8_t> hops;
  std::vector<Contact> contacts, joints;
  std::optional<Clusters> clusters;

 private:
  std::unique_ptr<const Aura> aura_;
};

TEST_F(ClusterTest, BodiesInContactMoveTogetherFromTheStart) {
  const auto a = place(Vec3(0, 0, 0)), b = place(Vec3(50, 0, 0)), c = place(Vec3(100, 0, 0)),
             d = place(Vec3(150, 0, 0));
  contact(a, b);
  contact(c, b);
  begin();
  EXPECT_TRUE(together(a, c));
  EXPECT_FALSE(together(a, d));
  EXPECT_EQ(clusters->size(b), 3u);
}

TEST_F(ClusterTest, JointedBodiesMoveTogether) {
  const auto a = place(Vec3(0, 0, 0)), b = place(Vec3(50, 0, 0));
  joint(a, b);
  begin();
  EXPECT_TRUE(together(a, b));
}

TEST_F(ClusterTest, BodiesThatMayTouchSoonMoveTogether) {
  const auto a = place(Vec3(0, 0, 0), Vec3(20, 0, 0)), b = place(Vec3(1.1, 0, 0)), c = place(Vec3(-1.5, 0, 0));
  complete_all();
  EXPECT_TRUE(together(a, b));
  EXPECT_FALSE(together(a, c));
}

TEST_F(ClusterTest, IsNotCompletedUnlessAskedFor) {
  const auto a = place(Vec3(0, 0, 0), Vec3(20, 0, 0)), b = place(Vec3(1.1, 0, 0)), c = place(Vec3(50, 0, 0));
  begin();
  EXPECT_FALSE(together(a, b));
  clusters->complete(b);
  EXPECT_TRUE(together(a, b));
  EXPECT_TRUE(clusters->is_complete(a));
  EXPECT_FALSE(clusters->is_complete(c));
}

/// A row in which each ball may touch the next one. Only the first ones are outside.
TEST_F(ClusterTest, IsCompletedOutsideUntilSomethingInsideIsFound) {
  std::vector<std::uint32_t> row;
  for (int i = 0; i < 12; ++i) row.push_back(place(Vec3(1.05 * i, 0, 0), Vec3(60 - 5 * i, 0, 0)));
  for (std::uint32_t i = 6; i < 11; ++i) contact(i, i + 1);
  for (const std::size_t outside : {3U, 12U}) {
    SCOPED_TRACE(outside);
    begin();
    clusters->note_outside(std::span(row).first(outside));
    for (const std::uint32_t i : std::span(row).first(outside)) clusters->complete_outside(i);
    EXPECT_TRUE(together(0, 2));
    EXPECT_EQ(clusters->is_outside(0), outside == row.size());
    EXPECT_EQ(together(0, 11), outside == row.size()) << "what stays is left alone";
  }
}

/// A ball outside that touches one inside stays, and is looked at no further.
TEST_F(ClusterTest, IsNotCompletedOutsideIfAPartOfItIsInside) {
  const auto a = place(Vec3(0, 0, 0)), b = place(Vec3(1, 0, 0)), c = place(Vec3(-1.05, 0, 0), Vec3(6, 0, 0));
  contact(a, b);
  begin();
  clusters->note_outside(std::array{a});
  clusters->complete_outside(a);
  EXPECT_FALSE(clusters->is_outside(a));
  EXPECT_FALSE(clusters->is_complete(a));
  EXPECT_FALSE(together(a, c));
  clusters->go_on(paths, hops, contacts, joints, {});
  EXPECT_FALSE(clusters->is_outside(a));
  clusters->note_outside(std::array{a, b});
  EXPECT_TRUE(clusters->is_outside(a)) << "each state counts anew";
}

TEST_F(ClusterTest, TheNaiveControlKnowsNoClusters) {
  rules.kind = AuraKind::kNone;
  const auto a = place(Vec3(0, 0, 0)), b = place(Vec3(0.5, 0, 0));
  contact(a, b);
  complete_all();
  EXPECT_FALSE(together(a, b));
}

TEST_F(ClusterTest, ReachesFurtherFromABodyThatLooksMoreHopsAhead) {
  const auto a = place(Vec3(0, 0, 0), Vec3(20, 0, 0)), b = place(Vec3(1.9, 0, 0));
  complete_all();
  EXPECT_FALSE(together(a, b));
  hops[b] = 3;
  complete_all();
  EXPECT_TRUE(together(a, b));
}

TEST_F(ClusterTest, EveryMemberIsVisitedOnce) {
  Random random("scenes");
  for (int run = 0; run < 50; ++run) {
    place_random_scene(random);
    complete_all();
    for (std::uint32_t i = 0; i < paths.size(); ++i) {
      std::multiset<std::uint32_t> visited, expected;
      clusters->for_each_member(i, [&](std::uint32_t j) { visited.insert(j); });
      for (std::uint32_t j = 0; j < paths.size(); ++j) {
        if (together(i, j)) expected.insert(j);
      }
      ASSERT_EQ(visited, expected);
      ASSERT_EQ(clusters->size(i), expected.size());
    }
  }
}

TEST_F(ClusterTest, AreThoseOfTheDefinition) {
  Random random("scenes");
  std::size_t united = 0;
  for (int run = 0; run < 300; ++run) {
    rules.lookahead = 1;
    place_random_scene(random);
    complete_all();
    const std::vector<std::uint32_t> of = by_definition();
    for (std::uint32_t a = 0; a < paths.size(); ++a) {
      for (std::uint32_t b = 0; b < a; ++b) {
        ASSERT_EQ(together(a, b), of[a] == of[b]) << "run " << run << ", bodies " << a << ", " << b;
        united += together(a, b);
      }
    }
  }
  EXPECT_GT(united, 5000u);
}

TEST_F(ClusterTest, CompletingTwiceChangesNothing) {
  Random random("scenes");
  place_random_scene(random);
  complete_all();
  std::vector<std::uint32_t> of;
  for (std::uint32_t i = 0; i < paths.size(); ++i) of.push_back(clusters->of(i));
  for (std::uint32_t i = 0; i < paths.size(); ++i) clusters->complete(i);
  for (std::uint32_t i = 0; i < paths.size(); ++i) EXPECT_EQ(clusters->of(i), of[i]);
}

}  // namespace
}  // namespace aurasim::core::testing
