// One world of the parts of its regions.
#include "core/world_cut.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "messages/samples.h"

namespace aurasim::core {
namespace {

WorldCut part_of(std::uint64_t first_id) {
  WorldCut part;
  part.step = 10, part.births_known = 14;
  part.bodies = messages::testing::hand_off_of(3).cluster;
  for (std::size_t i = 0; i < 3; ++i) part.bodies.bodies[i].id = BodyId{first_id + i};
  for (ManifoldRecord& manifold : part.bodies.manifolds) {
    for (ObjectRef* ref : {&manifold.object0, &manifold.object1}) {
      if (*ref >= 0) *ref = *ref / 10 + static_cast<ObjectRef>(first_id);
    }
  }
  return part;
}

TEST(WorldCut, PartsKeepTheirPointsAndJointValues) {
  const WorldCut high = part_of(100), low = part_of(3);
  const WorldCut whole = merge({high, low});
  ASSERT_EQ(whole.bodies.bodies.size(), 6U);
  EXPECT_EQ(whole.bodies.bodies.front().id, BodyId{3});
  EXPECT_TRUE(std::ranges::is_sorted(whole.bodies.manifolds, {},
                                     [](const auto& m) { return std::pair(m.object0, m.object1); }));
  ASSERT_EQ(whole.bodies.manifolds.size(), high.bodies.manifolds.size() + low.bodies.manifolds.size());
  for (const WorldCut* part : {&high, &low}) {
    for (const ManifoldRecord& wanted : part->bodies.manifolds) {
      const auto found = std::ranges::find_if(whole.bodies.manifolds, [&](const ManifoldRecord& m) {
        return m.object0 == wanted.object0 && m.object1 == wanted.object1;
      });
      ASSERT_NE(found, whole.bodies.manifolds.end());
      ASSERT_EQ(found->point_count, wanted.point_count);
      for (std::size_t i = 0; i < wanted.point_count * kContactPointDoubles; ++i) {
        EXPECT_EQ(whole.bodies.points[found->first_point * kContactPointDoubles + i],
                  part->bodies.points[wanted.first_point * kContactPointDoubles + i]);
      }
    }
  }
  ASSERT_EQ(whole.bodies.joints.size(), 2U);
  EXPECT_EQ(whole.bodies.joints[1].first_value, 3U);
}

TEST(WorldCut, OrdersAreThoseOfAllParts) {
  WorldCut one = part_of(0), two = part_of(10);
  one.orders = messages::testing::one_order_of_each_kind();
  two.orders = one.orders;
  one.orders.resize(5);
  one.last_order = 5, two.last_order = two.orders.back().sequence;
  const WorldCut whole = merge({one, two});
  EXPECT_EQ(whole.orders.size(), two.orders.size());
  EXPECT_EQ(whole.last_order, two.last_order);
}

TEST(WorldCut, ABodyIsInOnePart) {
  EXPECT_THROW(merge({part_of(0), part_of(2)}), std::invalid_argument);
  WorldCut one = part_of(0), two = part_of(10);
  one.under_way.push_back({9, two.bodies});
  EXPECT_THROW(merge({one, two}), std::invalid_argument);
  two = part_of(20);
  EXPECT_EQ(body_count(merge({one, two})), 9U);
  two.step = 11;
  EXPECT_THROW(merge({one, two}), std::invalid_argument);
  EXPECT_THROW(merge({}), std::invalid_argument);
}

}  // namespace
}  // namespace aurasim::core
