// Messages of a running node for its users: what it waits for, its last fault and its last news. No node waits long, or
// loses a body, without a message. Each message is logged once; the node's status carries the most urgent one. Time is
// passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/messages.h"
#include "node/pacer.h"
#include "physics/results.h"
#include "records/recorder.h"

namespace aurasim::process {

/// A region whose messages the next state needs and that have not arrived.
struct MissingRegion {
  core::RegionId region{};
  std::optional<std::string> long_step;  ///< text of long_step(); nothing: its node does not compute a step for long
  std::uint64_t refused = 0;             ///< number of its messages that were refused
};

class Notices {
 public:
  using Clock = std::chrono::steady_clock;

  /// `region`: this node's region, for the log. `now` is where the watch over the wall clock begins.
  Notices(core::RegionId region, const node::Instant& now) : region_(region), clock_watch_(now) {}

  /// Replaces the last news. Does not log it.
  void note_news(std::string text) { news_ = std::move(text); }
  /// Logs a fault and replaces the last one.
  void note_fault(std::string text);
  /// To be called when a world begins: its protocol counts refusals anew.
  void begin_refusals() { refusals_noted_ = 0; }
  /// Logs once that most of this node's bodies are in one cluster, which cannot be divided among nodes. `hosted`: all
  /// bodies of this node in state `step`. `remedy`: what helps in this run (remedy_for_heaps).
  void note_cluster(std::size_t largest_cluster, std::size_t hosted, core::Step step, const std::string& remedy);
  /// Logs refused messages of neighbours that are new. `refusals`: all of this world. The content of a refused message
  /// is lost for good, so the protocol has marked its sender dead.
  void note_refusals(const std::vector<core::Refusal>& refusals);
  /// Logs bodies that were removed because they exceeded the limits (core/limits.h).
  void note_removals(std::span<const physics::Removal> removals);
  /// Notes that the node waits for messages. True if it has waited for so long that note_missing() is to be called.
  bool waits_for_long(Clock::time_point now);
  /// Logs once that the node waits for these regions before it can compute state `next`. No region: no message.
  void note_missing(core::Step next, std::span<const MissingRegion> missing, Clock::time_point now);
  /// A state has been computed, so the node does not wait any more.
  void note_computed();
  /// Logs that the wall clock was set. `step`: the present state.
  void note_clock(const node::Instant& now, core::Step step);
  /// Logs once that the records have ended. A full disk ends the records, not the run.
  void note_records(const std::optional<records::RecordsEnd>& end);

  /// The message for the status: what the node waits for, else the last fault, else the last news.
  const std::string& text() const { return !waiting_.empty() ? waiting_ : !fault_.empty() ? fault_ : news_; }
  /// Number of bodies removed here since the start because they broke down.
  std::uint64_t broken_bodies() const { return broken_bodies_; }

 private:
  core::RegionId region_;
  node::ClockWatch clock_watch_;
  std::string news_, fault_, waiting_;
  std::optional<Clock::time_point> waiting_since_;
  std::size_t refusals_noted_ = 0;
  std::uint64_t broken_bodies_ = 0;
  bool says_records_end_ = false;
  bool says_large_cluster_ = false;
};

}  // namespace aurasim::process
