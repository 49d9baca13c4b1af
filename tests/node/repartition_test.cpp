// New regions for a run that stands still: who goes where, and that nobody is lost or doubled on the way.
#include "node/repartition.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "transport/memory_transport.h"

namespace aurasim::node {
namespace {

using core::BodyId;
using core::RegionId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr core::Generation kCensus = 3;

core::Scene balls_at(const std::vector<double>& xs) {
  core::Scene scene;
  scene.shapes = {{"ball", core::Sphere{0.5}}};
  scene.materials.emplace_back();
  scene.prototypes = {{"ball", 0, 0, 1, true}};
  for (const double x : xs) {
    core::InitialBody body;
    body.id = BodyId{scene.bodies.size()};
    body.pose.p_WB = {x, 0, 0};
    scene.bodies.push_back(body);
  }
  return scene;
}

/// What a node hosts, as its key frame tells.
core::Replica key_frame_of(Node& node, core::Generation generation = kCensus) {
  core::Replica replica;
  replica.source = node.region();
  replica.generation = generation;
  replica.stamp = node.current_step();
  replica.key_frame = true;
  for (const core::BodyState& body : node.world().snapshot().bodies) {
    replica.bodies.push_back({.id = body.id, .epoch = body.epoch, .host = node.region(), .p_WB = body.pose.p_WB});
  }
  return replica;
}

/// Two nodes side by side; the border is at 0 and then at `new_border`.
class Redrawn : public ::testing::Test {
 protected:
  void begin(const std::vector<double>& xs, double new_border) {
    scene_ = balls_at(xs);
    new_map_ = core::RegionMap::boxes({{-100, -100, new_border, 100}, {new_border, -100, 100, 100}});
    for (std::uint32_t r = 0; r < 2; ++r) {
      NodeSetup setup;
      setup.protocol.self = RegionId{r};
      setup.protocol.neighbour_distance_m = 1e9;
      nodes_.push_back(std::make_unique<Node>(setup, scene_, old_map_, network_.endpoint(RegionId{r})));
      nodes_.back()->start();
    }
    network_.advance_to(1);
    for (std::uint32_t r = 0; r < 2; ++r) {  // what the start has said is of the old map
      core::Inbox old;
      network_.endpoint(RegionId{r}).take(old);
    }
  }
  RepartitionSettings settings_of(std::uint32_t region) const { return {RegionId{region}, kCensus, {}, &new_map_}; }

  std::vector<HandOffRow> move_all() {
    std::vector<std::unique_ptr<Exchange>> exchanges;
    std::vector<std::vector<core::Departure>> departures;
    for (std::uint32_t r = 0; r < 2; ++r) {
      Census census(settings_of(r), 0);
      for (const auto& node : nodes_) census.accept(key_frame_of(*node));
      EXPECT_TRUE(census.complete());
      departures.push_back(find_new_hosts(settings_of(r), census.take(), *nodes_[r]));
    }
    for (std::uint32_t r = 0; r < 2; ++r) {
      exchanges.push_back(
          std::make_unique<Exchange>(settings_of(r), departures[r], network_.endpoint(RegionId{r}), *nodes_[r]));
    }
    network_.advance_to(network_.now_s() + 1);
    std::vector<HandOffRow> rows;
    for (const auto& exchange : exchanges) {
      EXPECT_TRUE(exchange->ready());
      for (const HandOffRow& row : exchange->finish()) rows.push_back(row);
    }
    return rows;
  }
  std::vector<std::uint64_t> hosted_by(std::uint32_t region) const {
    std::vector<std::uint64_t> ids;
    for (const core::BodyState& body : nodes_[region]->world().snapshot().bodies)
      ids.push_back(core::value_of(body.id));
    return ids;
  }

  core::Scene scene_;
  core::RegionMap old_map_ = core::RegionMap::boxes({{-100, -100, 0, 100}, {0, -100, 100, 100}});
  core::RegionMap new_map_ = old_map_;
  transport::MemoryNetwork network_{{{RegionId{1}}, {RegionId{0}}}, {}, 1};
  std::vector<std::unique_ptr<Node>> nodes_;
};

TEST_F(Redrawn, BodiesGoToWhomTheirPlaceBelongsNow) {
  begin({-30, -10, 10, 30}, -20);
  EXPECT_THAT(hosted_by(0), ElementsAre(0, 1));
  const std::vector<HandOffRow> rows = move_all();
  EXPECT_THAT(hosted_by(0), ElementsAre(0));
  EXPECT_THAT(hosted_by(1), ElementsAre(1, 2, 3));
  ASSERT_EQ(rows.size(), 2U) << "body 1, as its sender and as its receiver tell";
  for (const HandOffRow& row : rows) {
    EXPECT_EQ(row.body, BodyId{1});
    EXPECT_EQ(row.epoch, 1U);
  }
}

TEST_F(Redrawn, WhatTouchesStaysTogether) {
  begin({-10.5, -9.6, 30}, -10);
  move_all();
  const auto here = hosted_by(0), there = hosted_by(1);
  EXPECT_EQ(here.size() + there.size(), 3U);
  EXPECT_TRUE(here.empty() || there.size() == 1U) << "bodies 0 and 1 are one cluster";
}

TEST_F(Redrawn, NobodyMovesWhereNothingChanges) {
  begin({-30, 30}, 0);
  EXPECT_THAT(move_all(), IsEmpty());
}

TEST_F(Redrawn, ANodeWaitsForWhoHasNotSpoken) {
  begin({-30, -10, 10}, -20);
  Exchange exchange(settings_of(1), {}, network_.endpoint(RegionId{1}), *nodes_[1]);
  network_.advance_to(2);
  EXPECT_FALSE(exchange.ready());
}

TEST_F(Redrawn, ACensusNamesTheSilentAndIgnoresOtherStatesAndGenerations) {
  begin({-30, 30}, 0);
  Census census(settings_of(0), 0);
  census.accept(key_frame_of(*nodes_[0]));
  census.accept(key_frame_of(*nodes_[1], kCensus - 1));
  core::Replica later = key_frame_of(*nodes_[1]);
  later.stamp = 7;
  census.accept(later);
  core::Replica changes = key_frame_of(*nodes_[1]);
  changes.key_frame = false;
  census.accept(changes);
  EXPECT_THAT(census.silent(), ElementsAre(1));
  census.accept(key_frame_of(*nodes_[1]));
  census.accept(key_frame_of(*nodes_[1]));
  EXPECT_TRUE(census.complete());
  EXPECT_EQ(census.take().size(), 2U) << "twice is once";
}

}  // namespace
}  // namespace aurasim::node
