#include "physics/soft/near_bounds.h"

#include <random>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

Bounds random_bounds(std::mt19937_64& random, double far_m) {
  const btVector3 low(uniform(random, -far_m, far_m), uniform(random, -far_m, far_m), uniform(random, -1, 1));
  return {low, low + btVector3(uniform(random, 0.1, 2), uniform(random, 0.1, 2), uniform(random, 0.1, 2))};
}

TEST(NearBounds, AreNeverApartWhereBoxesTouch) {
  std::mt19937_64 random(71);
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const double far_m = i % 3 == 0 ? 1e5 : 3;
    const Bounds one = random_bounds(random, far_m);
    Bounds other = random_bounds(random, far_m);
    if (i % 2 == 0) {  // moves it until it touches along one axis
      const int axis = i / 2 % 3;
      for (int k = 0; k < 3; ++k) {
        const btScalar by = (k == axis ? one.high[k] : one.low[k]) - other.low[k];
        other.low[k] = k == axis ? one.high[k] : other.low[k] + by, other.high[k] += by;
      }
    }
    bool touch = true;
    for (int k = 0; k < 3; ++k) touch = touch && one.low[k] <= other.high[k] && other.low[k] <= one.high[k];
    NearBounds bounds;
    bounds.begin(3);
    bounds.note(1, one), bounds.note(2, other);
    if (touch) {
      ASSERT_FALSE(bounds.are_apart(1, 2) || bounds.are_apart(2, 1)) << i;
    }
    apart += bounds.are_apart(1, 2);
  }
  EXPECT_GT(apart, 5000);
}

TEST(NearBounds, ThoseOfAnEarlierStepDoNotCount) {
  NearBounds bounds;
  const Bounds one{{0, 0, 0}, {1, 1, 1}}, far{{5, 0, 0}, {6, 1, 1}};
  bounds.begin(3);
  bounds.note(1, one), bounds.note(2, far);
  EXPECT_TRUE(bounds.are_apart(1, 2));
  EXPECT_FALSE(bounds.are_apart(0, 1)) << "slot 0 is that of statics";
  bounds.begin(3);
  EXPECT_FALSE(bounds.are_apart(1, 2));
  bounds.note(1, one);
  EXPECT_FALSE(bounds.are_apart(1, 2)) << "the other one sleeps";
}

}  // namespace
}  // namespace aurasim::physics::testing
