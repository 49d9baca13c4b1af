// The records of a node (records/recorder.h) as its process goes through generations: begun anew, gone on with after a
// recovery, left to a successor. Keeps the frame times of states until they are confirmed and recorded.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "dds/dds_seams.h"
#include "records/recorder.h"

namespace aurasim::process {

class Records {
 public:
  /// Without a folder nothing is recorded.
  Records(std::optional<std::filesystem::path> folder, core::RegionId region)
      : folder_(std::move(folder)), region_(region) {}

  /// Begins new files. Throws std::runtime_error when that fails.
  void begin();
  /// Goes on with the files that are there, after state `step`; nothing: begins new ones. Returns why it failed; empty
  /// if it did not. The run goes on either way.
  std::string go_on_after(std::optional<core::Step> step);
  /// Writes nothing more.
  void close() { recorder_.reset(); }
  /// True if another process now records this region in the same folder.
  bool is_replaced() const { return recorder_ && recorder_->is_replaced(); }

  /// Counts time spent waiting for neighbours to the next state.
  void note_wait(double wait_ms) { wait_ms_ += wait_ms; }
  void note_frame(core::Step step, double frame_ms);
  /// Counts the exchanges of a state where regions are coupled.
  void note_exchanges(const dds::ExchangeTimes& times);
  /// All exchanges since begin().
  const records::Exchanges& exchanges() const { return exchanges_; }
  /// Forgets the frame times of states that will never be recorded.
  void forget_frames() { frame_times_.clear(); }

  void write(const node::StepReport& report);
  /// Writes what has joined a state after it was computed.
  void write_settling(const node::StepReport& report);
  void finish(node::Node& node, const records::Ending& ending);

  /// Null if nothing is recorded.
  records::Recorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }
  /// Where and why the records ended early.
  std::optional<records::RecordsEnd> end() const { return recorder_ ? recorder_->records_end() : std::nullopt; }

 private:
  std::optional<std::filesystem::path> folder_;
  core::RegionId region_;
  std::optional<records::Recorder> recorder_;
  std::map<core::Step, records::FrameTimes> frame_times_;  ///< of states that are not recorded yet
  records::Exchanges exchanges_;
  double wait_ms_ = 0;  ///< since the last state
};

}  // namespace aurasim::process
