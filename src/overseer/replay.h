// Plays a recording: which frames and texts are due, at which speed, from where. No clock: the time is passed in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

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
  /// The places in the recording at which it begins and ends: steps, until the run is begun anew, which turns its steps
  /// back, but not the place in the recording.
  core::Step first() const { return first_; }
  core::Step last() const { return places_.back(); }
  /// The places at which the run was begun anew, ascending.
  const std::vector<core::Step>& resets() const { return resets_; }

  void apply(const ReplayControl& control);

  struct Output {
    std::vector<WorldFrame> frames;
    std::map<Notice, std::string> texts;  ///< the latest of each
  };
  /// What is due by now.
  Output advance(double now_s);

  core::Step step() const { return table_.stamp(); }
  /// The place of what is shown, from first() to last().
  core::Step at() const { return at_; }
  bool playing() const { return playing_; }
  double speed() const { return speed_; }

 private:
  void lay_out();
  void seek(core::Step at);
  void tell_what_holds(Output& out);
  void tell(Notice notice, std::size_t chunk, Output& out);
  void emit_frame(const Chunk& chunk, Output& out);

  RecordingReader reader_;
  RecordedRun run_;
  std::vector<core::Step> places_;  ///< of each chunk
  std::vector<core::Step> resets_;
  core::Step first_ = 0;
  std::map<Notice, std::size_t> told_;  ///< chunk of the latest text of each kind
  std::size_t next_ = 0;                ///< chunk
  double position_ = 0;                 ///< place up to which all is due
  core::Step at_ = 0;
  double now_s_ = -1;
  bool playing_ = true;
  double speed_ = 1;
  bool jumped_ = true;  ///< the next frame has to be a key frame
  FrameDecoder decoder_;
  SlotTable table_;
};

}  // namespace aurasim::overseer
