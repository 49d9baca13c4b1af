#include "lab/scale/many_nodes.h"

#include <gtest/gtest.h>

#include "setup/launch_setup.h"

namespace aurasim::lab {
namespace {

NodeCosts measure(const ManyNodes& many) {
  const RainPlace place{
      AURASIM_SOURCE_DIR "/launch_configs/columns_rain.yaml",
      [](const config::Launch& launch, core::RegionId region) { return setup::node_setup(launch, region, 0); }};
  const auto costs = measure_many_nodes(many, place, [](double) { return true; });
  EXPECT_TRUE(costs);
  return costs.value_or(NodeCosts());
}

ManyNodes grid(std::size_t side) {
  ManyNodes many;
  many.side = side;
  many.run_s = 1.5;
  return many;
}

TEST(ManyNodes, ANodeTalksToItsNeighboursOnlyHoweverManyNodesThereAre) {
  const NodeCosts few = measure(grid(4)), many = measure(grid(9));
  // In a grid of 4 x 4 a region has 5.25 neighbours on average, and in one of 9 x 9 it has 6.7.
  EXPECT_GE(few.messages, 5.25);
  EXPECT_LT(many.messages / few.messages, 1.1 * 6.7 / 5.25);
  EXPECT_LT(many.bytes / few.bytes, 1.1 * 6.7 / 5.25);
  EXPECT_LT(many.memory_kB, 2000);  // pools of fixed sizes took 14 MB
}

/// So many coupled regions that a tree connects them (core/seam_tree.h).
TEST(ManyNodes, CoupledOnesTalkToAFewOnlyAndHaveTheSameBits) {
  ManyNodes few = grid(4), many = grid(9);
  few.coupled = many.coupled = true;
  const NodeCosts costs_of_few = measure(few), costs_of_many = measure(many);
  EXPECT_GT(costs_of_few.messages, 2) << "a batch and what comes along the tree, at least";
  EXPECT_LT(costs_of_many.messages / costs_of_few.messages, 1.1 * 6.7 / 5.25);
  EXPECT_LT(costs_of_many.bytes / costs_of_few.bytes, 1.1 * 6.7 / 5.25);
  EXPECT_EQ(costs_of_many.hash, measure(grid(9)).hash);
}

TEST(ManyNodes, AWorldFromWhichNodesDieGoesOnWithTheSameBits) {
  ManyNodes with_deaths = grid(5);
  with_deaths.deaths = 5;
  EXPECT_EQ(measure(with_deaths).hash, measure(grid(5)).hash);
}

}  // namespace
}  // namespace aurasim::lab
