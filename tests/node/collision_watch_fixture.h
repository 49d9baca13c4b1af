// Region 0 of two columns and what it is told, by hand, for tests of CollisionWatch.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/letters.h"
#include "core/protocol.h"
#include "core/round_shapes.h"
#include "node/collision_watch.h"

namespace aurasim::node {

/// Region 0 of two columns, and what region 1 says. Balls have a radius of half a metre.
class CollisionWatchTest : public ::testing::Test {
 protected:
  static constexpr double kStep_s = 1.0 / 60;
  static constexpr double kGravity_m_s2 = 9.81;
  static constexpr core::Step kLongAgo = -1'000'000;

  CollisionWatchTest() {
    settings_.aura.lookahead = kLookahead;
    settings_.aura.gravity = core::Vec3::Zero();
    settings_.neighbour_distance_m = 1e9;
    protocol_.emplace(settings_, map_, shapes_);
    look();
  }

  core::BodyState& place(std::uint64_t id, const core::Vec3& p, const core::Vec3& v = core::Vec3::Zero()) {
    core::BodyState state;
    state.id = core::testing::body(id);
    state.prototype = ball_;
    state.pose.p_WB = p;
    state.v_WB = v;
    return snapshot_.bodies.emplace_back(state);  // ids are given in ascending order
  }
  core::BodyState& state_of(std::uint64_t id) {
    return *std::find_if(snapshot_.bodies.begin(), snapshot_.bodies.end(),
                         [&](const core::BodyState& b) { return b.id == core::testing::body(id); });
  }
  void take_away(std::uint64_t id) {
    std::erase_if(snapshot_.bodies, [&](const core::BodyState& b) { return b.id == core::testing::body(id); });
  }
  /// Goes on to state `n`. Region 1 says where these bodies of its were in state n - 1.
  void go_to(core::Step n, std::vector<core::AuraRecord> foreign = {}) {
    while (now_ < n) {
      core::AuraBatch said = core::testing::batch(1, now_);
      said.map_version = map_.version();
      if (now_ == n - 1) said.updates = foreign;
      for (core::AuraRecord& a : said.updates) a.stamp = now_;
      inbox_.auras.push_back(std::move(said));
      protocol_->accept(inbox_);
      ++now_;
      protocol_->receive(now_);
      look();
    }
  }
  void pass(int states) { go_to(now_ + states); }
  core::AuraRecord foreign(std::uint64_t id, const core::Vec3& p, const core::Vec3& v = core::Vec3::Zero()) const {
    core::AuraRecord a = core::testing::aura(id);
    a.host = core::testing::region(1);
    a.prototype = ball_;
    a.pose.p_WB = p;
    a.v_WB = v;
    return a;
  }
  /// A body of ours has come from `source`, with what it was in a cluster with.
  void join(std::initializer_list<std::uint64_t> ids, std::uint32_t source = 1, core::Step stamp = 0,
            core::Step birth = 0) {
    core::Adoption adoption;
    adoption.source = core::testing::region(source);
    adoption.stamp = stamp;
    for (const std::uint64_t id : ids) {
      adoption.cluster.bodies.push_back(core::testing::record_of(id, 1));
      adoption.cluster.bodies.back().birth = birth;
    }
    watch_.join(adoption);
  }

  /// Judges the first contact of two bodies, in the present state.
  SeenCollision touch(std::uint64_t a, std::uint64_t b, double penetration_m, double relative_speed_m_s) {
    const physics::Collision contact{now_, core::testing::body(a), core::testing::body(b), penetration_m,
                                     relative_speed_m_s};
    seen_.clear();
    watch_.judge({&contact, 1}, last_violation_, seen_);
    EXPECT_EQ(seen_.size(), 1u) << "every first contact is reported";
    return seen_.at(0);
  }
  const std::vector<SeenCollision>& judge_arrivals() {
    seen_.clear();
    watch_.judge_arrivals(snapshot_, protocol_->matching(), last_violation_, seen_);
    return seen_;
  }
  const std::vector<SeenCollision>& compare() {
    seen_.clear();
    watch_.compare(snapshot_, protocol_->matching(), last_violation_, seen_);
    return seen_;
  }

  static constexpr int kLookahead = 2;

  core::ProtocolSettings settings_;
  core::testing::RoundShapes shapes_;
  const core::PrototypeId ball_ = shapes_.sphere(0.5);
  const core::RegionMap map_ = core::RegionMap::columns(2, 100);
  std::optional<core::Protocol> protocol_;
  CollisionWatch watch_{kStep_s, kGravity_m_s2, kLookahead, shapes_};
  core::Snapshot snapshot_;
  core::Inbox inbox_;
  std::vector<SeenCollision> seen_;
  core::Step now_ = 0;
  core::Step last_violation_ = kLongAgo;

 private:
  void look() {
    snapshot_.step = now_;
    protocol_->observe(snapshot_);
  }
};

}  // namespace aurasim::node
