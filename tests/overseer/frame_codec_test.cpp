// Frames for clients of any speed: whatever a client misses, the next frame makes up for.
#include "overseer/frame_codec.h"

#include <iostream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "overseer/page_reader.h"

namespace aurasim::overseer {
namespace {

using testing::PageWorld;

/// A world that changes frame by frame, and clients that get some of the frames.
class Frames : public ::testing::Test {
 protected:
  BodyChange& change(Slot slot) {
    BodyChange& change = frame_.changed.emplace_back();
    change.body = bodies_[slot];
    return change;
  }
  void create(Slot slot, std::uint64_t id, const core::Vec3& p = core::Vec3::Zero()) {
    bodies_[slot] = {};
    bodies_[slot].slot = slot;
    bodies_[slot].id = core::BodyId{id};
    bodies_[slot].p_WB = p;
    BodyChange& row = change(slot);
    row.created = row.host_changed = row.moved = true;
  }
  void move(Slot slot, const core::Vec3& p) {
    bodies_[slot].p_WB = p;
    change(slot).moved = true;
  }
  void hand_over(Slot slot, std::uint32_t host) {
    bodies_[slot].host = core::RegionId{host};
    ++bodies_[slot].epoch;
    BodyChange& row = change(slot);
    row.host_changed = row.handed_over = true;
  }
  void remove(Slot slot) { frame_.deleted.push_back(slot); }
  void end_frame() {
    frame_.stamp += 3;
    table_.apply(frame_);
    fast_.note(frame_);
    slow_.note(frame_);
    frame_.deleted.clear();
    frame_.changed.clear();
    frame_.restart = false;
    fast_page_.read(fast_.encode(table_));
  }
  void slow_one_reads() { slow_page_.read(slow_.encode(table_)); }
  void expect_slow_page_has_all() {
    slow_one_reads();
    const auto fast = fast_page_.by_id();
    const auto slow = slow_page_.by_id();
    ASSERT_EQ(fast.size(), slow.size());
    for (const auto& [id, body] : fast) {
      ASSERT_TRUE(slow.contains(id)) << id;
      EXPECT_EQ(slow.at(id).p, body.p) << id;
      EXPECT_EQ(slow.at(id).host, body.host) << id;
      EXPECT_EQ(slow.at(id).epoch, body.epoch) << id;
    }
    EXPECT_EQ(slow.size(), table_.body_count());
  }

  std::map<Slot, ViewBody> bodies_;
  WorldFrame frame_;
  SlotTable table_;
  ClientFrames fast_, slow_;
  PageWorld fast_page_, slow_page_;
};

TEST_F(Frames, TheFirstIsAKeyFrame) {
  create(0, 10, {1, 2, 3});
  end_frame();
  slow_one_reads();
  EXPECT_EQ(slow_page_.key_frames, 1);
  EXPECT_EQ(slow_page_.by_id().at(10).p, core::Vec3(1, 2, 3));
  EXPECT_EQ(slow_page_.stamp, 3);
}

TEST_F(Frames, WhatDoesNotChangeIsNotSent) {
  for (Slot i = 0; i < 100; ++i) create(i, i);
  end_frame();
  slow_one_reads();
  end_frame();
  EXPECT_EQ(slow_.encode(table_).size(), 32U);
  EXPECT_FALSE(slow_.has_news());
}

TEST_F(Frames, AreMergedForASlowClient) {
  create(0, 10);
  create(1, 11);
  end_frame();
  slow_one_reads();
  move(0, {1, 0, 0});
  end_frame();
  move(0, {2, 0, 0});
  hand_over(1, 3);
  end_frame();
  EXPECT_EQ(slow_.merged(), 1U);
  expect_slow_page_has_all();
  EXPECT_EQ(slow_page_.key_frames, 1);
  EXPECT_EQ(slow_page_.bodies.at(1).flags, 4) << "just handed over";
  hand_over(0, 2);
  end_frame();
  slow_one_reads();
  EXPECT_EQ(slow_page_.bodies.at(1).flags, 4) << "nothing new of that one";
}

TEST_F(Frames, ABodyThatComesAndGoesUnseenIsNeverTold) {
  create(0, 10);
  end_frame();
  slow_one_reads();
  create(1, 11);
  end_frame();
  remove(1);
  end_frame();
  expect_slow_page_has_all();
}

TEST_F(Frames, ASlotThatIsGivenOutAgainUnseenIsDeletedAndCreated) {
  create(0, 10);
  end_frame();
  slow_one_reads();
  for (std::uint64_t id = 11; id < 15; ++id) {
    remove(0);
    end_frame();
    create(0, id, {static_cast<double>(id), 0, 0});
    end_frame();
  }
  expect_slow_page_has_all();
  EXPECT_EQ(slow_page_.bodies.at(0).id, 14U);
}

TEST_F(Frames, ARestartIsAKeyFrame) {
  create(0, 10);
  create(1, 11);
  end_frame();
  slow_one_reads();
  frame_.restart = true;
  frame_.generation = 1;
  create(0, 20);
  end_frame();
  expect_slow_page_has_all();
  EXPECT_EQ(slow_page_.key_frames, 2);
  EXPECT_EQ(slow_page_.generation, 1U);
}

TEST_F(Frames, FarFromTheOriginPositionsKeepTheirMillimetres) {
  create(0, 10, {100'000.123, -50'000.456, 3.25});
  end_frame();
  EXPECT_LT((fast_page_.by_id().at(10).p - core::Vec3(100'000.123, -50'000.456, 3.25)).norm(), 5e-4);
}

TEST_F(Frames, ASmallMoveTakesAFewBytes) {
  for (Slot i = 0; i < 40; ++i) create(i, i);
  end_frame();
  slow_one_reads();
  const auto size_of_move = [&](const core::Vec3& p) {
    move(20, p);
    end_frame();
    const Bytes bytes = slow_.encode(table_);
    slow_page_.read(bytes);
    EXPECT_LE((slow_page_.bodies.at(20).p - p).cwiseAbs().maxCoeff(), kGrid_m / 2);
    return bytes.size() - 32;
  };
  EXPECT_EQ(size_of_move({0.01, 0, 0}), 1U + 4 + 3) << "head, slot, three bytes";
  EXPECT_EQ(size_of_move({0.00995, 0, 0}), 0U) << "less than the grid";
  EXPECT_EQ(size_of_move({5, 0, -2}), 1U + 4 + 6);
  EXPECT_EQ(size_of_move({5'000'000, 0, -9'000'000}), 1U + 4 + 18);
}

TEST_F(Frames, RotationsFollowExactlyThroughAnyTurn) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  create(0, 10);
  end_frame();
  Eigen::Quaternionf q = Eigen::Quaternionf::Identity();
  for (int i = 0; i < 3000; ++i) {
    const float far = i % 3 == 0 ? 1.0F : 0.05F;
    const Eigen::Quaternionf turn(1, far * normal(random), far * normal(random), far * normal(random));
    q = (q * turn).normalized();
    bodies_[0].q_WB = q;
    change(0).moved = true;
    end_frame();
    ASSERT_EQ(fast_page_.bodies.at(0).packed, pack_rotation(q)) << i;
  }
}

/// From 10 m above the origin along x, at pixels of a milliradian.
Eye eye_along_x() {
  Eye eye;
  eye.p_W = {0, 0, 10};
  eye.half_angle_rad = 0.6;
  eye.pixel_rad = 1e-3;
  return eye;
}

TEST_F(Frames, WhatCannotBeSeenIsToldLater) {
  create(0, 10, {5, 0, 10});
  create(1, 11, {400, 0, 10});
  create(2, 12, {-20, 0, 10});
  end_frame();
  slow_one_reads();
  slow_.look(eye_along_x());
  const auto error_m = [&](Slot slot) { return (slow_page_.bodies.at(slot).p - bodies_[slot].p_WB).norm(); };
  for (int i = 1; i <= 8; ++i) {
    for (Slot slot = 0; slot < 3; ++slot) move(slot, bodies_[slot].p_WB + core::Vec3(0, 0.02, 0));
    end_frame();
    slow_one_reads();
    EXPECT_LE(error_m(0), 0.003 + kGrid_m) << "half a pixel at 5 m";
    EXPECT_LE(error_m(1), 0.2 + kGrid_m) << "half a pixel at 400 m";
    EXPECT_LE(error_m(2), 0.5 + kGrid_m) << "behind the eye";
  }
  EXPECT_EQ(slow_page_.poses, 3 + 8) << "the near one alone has been told on the way";
  slow_.look(std::nullopt);
  end_frame();
  expect_slow_page_has_all();
}

TEST_F(Frames, BodiesAtRestCostNothing) {
  for (Slot i = 0; i < 100; ++i) create(i, i, {5, 0, 10});
  end_frame();
  slow_one_reads();
  slow_.look(eye_along_x());
  for (int i = 0; i < 20; ++i) {
    for (Slot slot = 0; slot < 100; ++slot) move(slot, {5, 0, 10 + (i % 2) * 1e-3});  // they tremble
    end_frame();
    EXPECT_EQ(slow_.encode(table_).size(), 32U);
  }
}

TEST_F(Frames, AfterAnyHistoryTheNextFrameMakesUpForAllThatWasMissed) {
  std::mt19937 random(7);
  std::cout << "seed 7\n";
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  std::uint64_t next_id = 0;
  for (int round = 0; round < 3000; ++round) {
    const Slot slot = static_cast<Slot>(below(40));
    const bool there = table_.body(slot) != nullptr;
    if (!there) create(slot, next_id++, core::Vec3::Constant(static_cast<double>(round)));
    if (there && below(3) == 0) remove(slot);
    if (there && frame_.deleted.empty()) {
      below(2) == 0 ? move(slot, core::Vec3::Constant(static_cast<double>(round)))
                    : hand_over(slot, static_cast<std::uint32_t>(below(9)));
    }
    end_frame();
    if (below(5) == 0) expect_slow_page_has_all();
  }
}

TEST(Rotations, KeepWithinAQuarterOfADegreeInFourBytes) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  float worst = 0;
  for (int i = 0; i < 20'000; ++i) {
    Eigen::Quaternionf q(normal(random), normal(random), normal(random), normal(random));
    q.normalize();
    worst = std::max(worst, q.angularDistance(unpack_rotation(pack_rotation(q))));
  }
  EXPECT_LT(worst, 0.25F * 3.14159F / 180);
}

TEST(Overlays, SayHowManyAndWhich) {
  const std::vector<AuraDisc> auras = {{3, 1.5F}, {9, 0.25F}};
  const std::vector<SlotPair> links = {{1, 2}};
  const Bytes bytes = encode_overlays(auras, links, {});
  testing::BytesIn in(bytes);
  EXPECT_EQ(in.get<std::uint8_t>(), 2);
  EXPECT_EQ(in.get<std::uint8_t>(), 0);
  EXPECT_EQ(in.get<std::uint16_t>(), 2);
  for (const std::uint32_t count : {2U, 1U, 0U}) EXPECT_EQ(in.get<std::uint32_t>(), count);
  EXPECT_EQ(in.get<std::uint32_t>(), 3U);
  EXPECT_EQ(in.get<float>(), 1.5F);
  EXPECT_EQ(in.get<std::uint32_t>(), 9U);
  EXPECT_EQ(in.get<float>(), 0.25F);
  EXPECT_EQ(in.get<std::uint32_t>(), 1U);
  EXPECT_EQ(in.get<std::uint32_t>(), 2U);
  EXPECT_TRUE(in.at_end());
}

}  // namespace
}  // namespace aurasim::overseer
