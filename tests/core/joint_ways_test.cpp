#include "core/joint_ways.h"

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

std::vector<std::uint32_t> way(const std::vector<JointEnds>& joints, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> ids;
  for (const JointId id : JointWays(joints).way(JointId{from}, JointId{to})) ids.push_back(value_of(id));
  return ids;
}

TEST(JointWays, GoOverBodiesTheShortestWay) {
  // A ring of five bodies, and one joint across.
  const std::vector<JointEnds> ring = {{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 1}, {2, 5}};
  EXPECT_EQ(way(ring, 0, 1), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(way(ring, 0, 3), (std::vector<std::uint32_t>{4, 3}));
  EXPECT_EQ(way(ring, 4, 1).size(), 2u);
}

TEST(JointWays, DoNotGoOverTheWorld) {
  EXPECT_TRUE(way({{1, std::nullopt}, {2, std::nullopt}}, 0, 1).empty());
  EXPECT_EQ(way({{1, std::nullopt}, {2, std::nullopt}, {1, 2}}, 0, 1), (std::vector<std::uint32_t>{2, 1}));
}

TEST(JointWays, OfAJointToItselfThereIsNone) { EXPECT_TRUE(way({{1, 2}}, 0, 0).empty()); }

}  // namespace
}  // namespace aurasim::core
