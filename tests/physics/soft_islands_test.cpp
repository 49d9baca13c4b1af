// What is known of sleepers is found again only where something has changed.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <gtest/gtest.h>

#include "physics/moving_body.h"
#include "physics/soft/islands.h"
#include "physics/soft/touch.h"

namespace aurasim::physics::testing {
namespace {

/// Two rows of three sleepers that touch.
class SoftIslandsTest : public ::testing::Test {
 protected:
  SoftIslandsTest() {
    for (auto& body : bodies_) {
      body = std::make_unique<MovingBody>(btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &shape_, {1, 1, 1}));
      body->forceActivationState(ISLAND_SLEEPING);
      body->setDeactivationTime(3);
      islands_.insert(*body);
    }
    step({touch(0, 1), touch(1, 2), touch(3, 4), touch(4, 5)});
  }
  ~SoftIslandsTest() override {
    for (auto& body : bodies_) {
      if (body) islands_.remove(*body);
    }
  }

  std::uint32_t slot(std::size_t i) const { return slot_of(*bodies_[i]); }
  SleepersTouch touch(std::size_t i, std::size_t j) const { return {slot(i), slot(j)}; }
  void step(const std::vector<SleepersTouch>& touches) {
    islands_.call(team_);
    for (const btRigidBody* body : islands_.awake()) islands_.look_at(*body);
    islands_.find_parts({}, touches, {});
    islands_.settle({}, {});
    islands_.rest(btScalar(0.01), team_);
  }
  void wake(std::size_t i) {
    bodies_[i]->setDeactivationTime(0);
    note_change(*bodies_[i]);
  }
  /// Does the body move in the step?
  std::vector<bool> moving() const {
    std::vector<bool> moving;
    for (const auto& body : bodies_) moving.push_back(body && islands_.moves(slot_of(*body)));
    return moving;
  }

  btSphereShape shape_{1};
  std::array<std::unique_ptr<MovingBody>, 6> bodies_;
  SoftIslands islands_;
  soft::Team team_{1};
};

TEST_F(SoftIslandsTest, SleepersAreKnownOnceTheirTouchesHaveBeenFound) {
  islands_.call(team_);
  EXPECT_TRUE(islands_.forgotten().empty());
  EXPECT_TRUE(islands_.are_at_rest());
}

TEST_F(SoftIslandsTest, ABodyThatLeavesMakesOnlyItsPartForgotten) {
  const std::vector<std::uint32_t> rest = {slot(0), slot(2)};
  islands_.remove(*bodies_[1]);
  bodies_[1] = nullptr;
  EXPECT_TRUE(std::ranges::is_permutation(islands_.forgotten(), rest));
  step({});
  wake(0), wake(3);
  step({});
  EXPECT_EQ(moving(), (std::vector<bool>{true, false, false, true, true, true}));
}

TEST_F(SoftIslandsTest, ASleeperThatComesIsFoundAlone) {
  MovingBody guest(btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &shape_, {1, 1, 1}));
  guest.forceActivationState(ISLAND_SLEEPING);
  guest.setDeactivationTime(3);
  islands_.insert(guest);
  islands_.call(team_);
  ASSERT_EQ(islands_.forgotten().size(), 1);
  EXPECT_EQ(islands_.forgotten()[0], slot_of(guest));
  const std::vector<SleepersTouch> touches = {{slot_of(guest), slot(2)}};
  islands_.find_parts({}, touches, {});
  islands_.settle({}, {});
  wake(0);
  step({});
  EXPECT_TRUE(islands_.moves(slot_of(guest)));
  EXPECT_EQ(moving(), (std::vector<bool>{true, true, true, false, false, false}));
  islands_.remove(guest);
}

TEST_F(SoftIslandsTest, AWakingPartForgetsNoOther) {
  wake(4);
  step({});
  EXPECT_EQ(moving(), (std::vector<bool>{false, false, false, true, true, true}));
  islands_.call(team_);
  EXPECT_TRUE(islands_.forgotten().empty());
}

TEST_F(SoftIslandsTest, ASleeperWithAnotherBlockLeavesItsPart) {
  place_of(*bodies_[2]).block = {1, 0};
  note_change(*bodies_[2]);
  islands_.call(team_);
  const std::vector<std::uint32_t> row = {slot(0), slot(1), slot(2)};
  EXPECT_TRUE(std::ranges::is_permutation(islands_.forgotten(), row));
}

}  // namespace
}  // namespace aurasim::physics::testing
