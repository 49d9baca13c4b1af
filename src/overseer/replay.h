// Plays a recording: decides which frames and texts are due, at the chosen speed and place. No clock: the time is
// passed in.
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

/// Description of a recording.
struct RecordedRun {
  std::string scene;
  double step_s = 1.0 / 60;
  double tick_hz = 20;
};
std::string recorded_run_text(const RecordedRun& run);

class Replay {
 public:
  /// Opens a recording. Throws BadRecording.
  explicit Replay(const std::filesystem::path& file);

  const RecordedRun& run() const { return run_; }
  /// First and last place in the recording. Places are steps until the run is reset: then steps go back, but places go
  /// on.
  core::Step first() const { return first_; }
  core::Step last() const { return places_.back(); }
  /// Places at which the run was reset, ascending.
  const std::vector<core::Step>& resets() const { return resets_; }

  void apply(const ReplayControl& control);

  struct Output {
    std::vector<WorldFrame> frames;
    std::map<Notice, std::string> texts;  ///< the latest text of each kind
  };
  /// Returns everything that is due at time `now_s`.
  Output advance(double now_s);

  core::Step step() const { return table_.stamp(); }
  /// Place that is shown, from first() to last().
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
  std::vector<core::Step> places_;  ///< place of each chunk
  std::vector<core::Step> resets_;
  core::Step first_ = 0;
  std::map<Notice, std::size_t> told_;  ///< chunk of the latest text of each kind that was sent
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
