// A recording shows what was there: in order, from any step, at any speed; and a bad file is refused.
#include "overseer/replay.h"

#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scratch_folder.h"

namespace aurasim::overseer {
namespace {

constexpr core::Step kLast = 600;
constexpr Slot kBodies = 20;
using Action = ReplayControl::Action;

class Recording : public ::testing::Test {
 protected:
  void SetUp() override { record(); }

  /// Ten seconds in which bodies fly by: at step s there are those with s in [10 slot, 10 slot + 300), at x = s.
  static bool is_there(Slot slot, core::Step step) { return step >= 10 * slot && step < 10 * slot + 300; }

  void record() {
    RecordingWriter writer(file_);
    writer.write(ChunkKind::kAbout, recorded_run_text({"flight", 1.0 / 60, 20}), 0);
    writer.write(ChunkKind::kScene, R"({"type":"scene"})", 0);
    for (core::Step step = 0; step <= kLast; step += 3) {
      WorldFrame frame;
      frame.stamp = step;
      frame.restart = step == 0;
      for (Slot slot = 0; slot < kBodies; ++slot) {
        const bool there = is_there(slot, step), before = step > 0 && is_there(slot, step - 3);
        if (!there && before) frame.deleted.push_back(slot);
        if (!there) continue;
        BodyChange& change = frame.changed.emplace_back();
        change.body.slot = slot;
        change.body.id = core::BodyId{slot + 50U};
        change.body.p_WB.x() = static_cast<double>(step);
        change.created = change.host_changed = !before;
        change.moved = true;
      }
      writer.write(frame, static_cast<double>(step) / 60);
      if (step % 15 == 0) writer.write(ChunkKind::kStatus, "status " + std::to_string(step), 0);
    }
  }

  void play(Replay& replay, double seconds) {
    for (double t = 0; t < seconds; t += 0.01) take(replay.advance(now_s_ += 0.01));
  }
  void take(const Replay::Output& output) {
    for (const WorldFrame& frame : output.frames) {
      restarts_ += frame.restart;
      frames_ += 1;
      table_.apply(frame);
    }
  }
  void expect_world_of(core::Step step) {
    EXPECT_EQ(table_.stamp(), step);
    for (Slot slot = 0; slot < kBodies; ++slot) {
      const ViewBody* body = table_.body(slot);
      ASSERT_EQ(body != nullptr, is_there(slot, step)) << "slot " << slot << " at " << step;
      if (body == nullptr) continue;
      EXPECT_EQ(body->id, core::BodyId{slot + 50U});
      EXPECT_EQ(body->p_WB.x(), static_cast<double>(step));
    }
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path file_ = scratch_.path() / "recording";
  SlotTable table_;
  double now_s_ = 100;
  int restarts_ = 0;
  int frames_ = 0;
};

TEST_F(Recording, PlaysInItsTimeToItsEnd) {
  Replay replay(file_);
  EXPECT_EQ(replay.run().scene, "flight");
  EXPECT_EQ(replay.last(), kLast);
  EXPECT_EQ(replay.first(), 0);
  EXPECT_TRUE(replay.resets().empty());
  play(replay, 5.005);
  EXPECT_NEAR(static_cast<double>(table_.stamp()), 300, 6);
  expect_world_of(table_.stamp());
  play(replay, 6);
  expect_world_of(kLast);
  EXPECT_FALSE(replay.playing());
  EXPECT_EQ(restarts_, 1) << "key frames on the way are differences like all others";
  EXPECT_EQ(frames_, kLast / 3 + 1);
}

TEST_F(Recording, CanBePausedAndSpedUp) {
  Replay replay(file_);
  play(replay, 1);
  replay.apply({Action::kPause, 0});
  const core::Step at = replay.step();
  play(replay, 5);
  EXPECT_EQ(replay.step(), at);
  replay.apply({Action::kPlay, 0});
  replay.apply({Action::kSpeed, 10});
  play(replay, 0.5);
  EXPECT_NEAR(static_cast<double>(replay.step()), static_cast<double>(at) + 300, 15);
}

TEST_F(Recording, ShowsAnyStepThatIsSought) {
  Replay replay(file_);
  play(replay, 0.1);
  replay.apply({Action::kPause, 0});
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const auto step = static_cast<core::Step>(random() % (kLast + 1));
    replay.apply({Action::kSeek, static_cast<double>(step)});
    play(replay, 0.02);
    expect_world_of(step / 3 * 3);
  }
  replay.apply({Action::kSeek, 1e12});
  play(replay, 0.02);
  expect_world_of(kLast);
}

TEST_F(Recording, ThatWasCutOffIsWholeUpToThere) {
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
  Replay replay(file_);
  EXPECT_GT(replay.last(), 200);
  EXPECT_LT(replay.last(), 400);
  play(replay, 11);
  expect_world_of(replay.last());
}

/// A run that was reset at step 120, under another scene, and went on to 60.
class RecordingOfAReset : public Recording {
 protected:
  void SetUp() override {
    Recording::SetUp();
    RecordingWriter writer(file_);
    writer.write(ChunkKind::kAbout, recorded_run_text({"two runs", 1.0 / 60, 20}), 0);
    writer.write(ChunkKind::kScene, "first scene", 0);
    for (core::Step step = 0; step <= 120; step += 3) write(writer, 0, step);
    for (core::Step step = 0; step <= 60; step += 3) {
      write(writer, 1, step);
      if (step == 0) writer.write(ChunkKind::kScene, "second scene", 0);
    }
  }
  static void write(RecordingWriter& writer, core::Generation generation, core::Step step) {
    WorldFrame frame;
    frame.generation = generation;
    frame.stamp = step;
    frame.restart = step == 0;
    BodyChange& change = frame.changed.emplace_back();
    change.body.p_WB.x() = static_cast<double>(1000 * generation) + static_cast<double>(step);
    change.created = change.host_changed = frame.restart;
    change.moved = true;
    writer.write(frame, static_cast<double>(step) / 60);
  }
  double x() const { return table_.body(0)->p_WB.x(); }
};

TEST_F(RecordingOfAReset, TheBarGoesOnWhereTheStepsBeginAnew) {
  Replay replay(file_);
  EXPECT_EQ(replay.last(), 181) << "120, one for the reset, 60";
  EXPECT_EQ(replay.resets(), std::vector<core::Step>{121});
  core::Step before = 0;
  while (replay.playing()) {
    play(replay, 0.05);
    EXPECT_GE(replay.at(), before);
    before = replay.at();
  }
  EXPECT_EQ(replay.at(), 181);
  EXPECT_EQ(replay.step(), 60);
  EXPECT_EQ(x(), 1060);
}

TEST_F(RecordingOfAReset, EveryPlaceOfTheBarShowsItsOwnRun) {
  Replay replay(file_);
  replay.apply({Action::kPause, 0});
  for (const auto& [at, shown] : std::vector<std::pair<double, double>>{{60, 60}, {121, 1000}, {30, 30}, {151, 1030}}) {
    replay.apply({Action::kSeek, at});
    play(replay, 0.02);
    EXPECT_EQ(x(), shown) << at;
    EXPECT_EQ(replay.at(), static_cast<core::Step>(at));
  }
}

TEST_F(RecordingOfAReset, AJumpTellsTheSceneOfThere) {
  Replay replay(file_);
  replay.apply({Action::kPause, 0});
  const auto scene_at = [&](double at) {
    replay.apply({Action::kSeek, at});
    const Replay::Output output = replay.advance(now_s_ += 0.01);
    return output.texts.contains(Notice::kScene) ? output.texts.at(Notice::kScene) : "as before";
  };
  EXPECT_EQ(scene_at(10), "first scene");
  EXPECT_EQ(scene_at(150), "second scene");
  EXPECT_EQ(scene_at(170), "as before");
  EXPECT_EQ(scene_at(20), "first scene");
}

TEST_F(Recording, OtherFilesAreRefused) {
  std::ofstream(file_) << "not a recording";
  EXPECT_THROW(Replay{file_}, BadRecording);
  std::ofstream(file_) << "AURAREC1";
  EXPECT_THROW(Replay{file_}, BadRecording);
  EXPECT_THROW(RecordingWriter("/nowhere/at/all"), BadRecording);
}

TEST_F(Recording, SpoiltBytesDoNoHarm) {
  std::string original;
  {
    std::ifstream in(file_, std::ios::binary);
    original.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::mt19937 random(9);
  for (int i = 0; i < 100; ++i) {
    std::string bytes = original;
    for (int k = 0; k < 20; ++k) bytes[8 + random() % (bytes.size() - 8)] = static_cast<char>(random());
    std::ofstream(file_, std::ios::binary) << bytes;
    try {
      Replay replay(file_);
      replay.apply({Action::kSpeed, 100});
      play(replay, 0.2);
    } catch (const BadRecording&) {
    }
  }
}

}  // namespace
}  // namespace aurasim::overseer
