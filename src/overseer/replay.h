// Plays a recording: which frames and texts are due, at which speed, from where. No clock: the time is passed in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "overseer/client_outbox.h"
#include "overseer/page_input.h"
#include "overseer/recording.h"

namespace aurasim::overseer {

/// What a recording says of itself.
struct RecordedRun {
  std::string scene;
  double step_s = 1.0 / 60;
  double tick_hz = 20;
};
std::string recorded_run_text(const RecordedRun& run);

class Replay {
 public:
  /// Throws BadRecording.
  explicit Replay(const std::filesystem::path& file);

  const RecordedRun& run() const { return run_; }
  core::Step first_step() const { return first_step_; }
  core::Step last_step() const { return last_step_; }

  void apply(const ReplayControl& control);

  struct Output {
    std::vector<WorldFrame> frames;
    std::map<Notice, std::string> texts;  ///< the latest of each
  };
  /// What is due by now.
  Output advance(double now_s);

  core::Step step() const { return table_.stamp(); }
  bool playing() const { return playing_; }
  double speed() const { return speed_; }

 private:
  void seek(core::Step step);
  void emit(const Chunk& chunk, Output& out);
  void emit_frame(const Chunk& chunk, Output& out);

  RecordingReader reader_;
  RecordedRun run_;
  core::Step first_step_ = 0;
  core::Step last_step_ = 0;
  std::size_t next_ = 0;  ///< chunk
  double position_ = 0;   ///< step
  double now_s_ = -1;
  bool playing_ = true;
  double speed_ = 1;
  bool jumped_ = true;  ///< the next frame has to be a key frame
  core::Generation generation_ = 0;
  SlotTable table_;
};

}  // namespace aurasim::overseer
