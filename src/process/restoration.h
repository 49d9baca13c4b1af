// How far this node is in a recovery, or on the way to an earlier state that a client asked for: the newest restore
// command that it knows, the generation that it begins with it, and how the recovery may end otherwise. Uses no DDS:
// time is passed in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "messages/control_messages.h"
#include "process/recovery.h"

namespace aurasim::process {

class Restoration {
 public:
  using Clock = std::chrono::steady_clock;

  /// The node waits from now on.
  void begin(Clock::time_point now);
  /// An attempt to agree on a state begins. `generation`: the one that the node computes or waits to start.
  void begin_attempt(core::Generation generation);
  /// All nodes agree on the newest restore, and this node begins its generation.
  void go_back();
  /// This node has begun the generation of the restore.
  void finish() { is_going_back_ = false; }
  /// The node computes in a world again.
  void begin_world() { stop_asked_ = false; }

  /// Replaces the restore: `restore` was sent, or received and accepted.
  void use(const messages::RunCommand& restore) { restore_ = restore; }
  const std::optional<messages::RunCommand>& restore() const { return restore_; }
  /// True if a restore is known whose generation this node has not begun. `generation`: as in begin_attempt().
  bool is_agreed(core::Generation generation) const { return restore_ && restore_->generation > newest(generation); }
  /// The newest generation that this node computes in, or is about to begin.
  core::Generation newest(core::Generation generation) const { return std::max(generation, restoring_); }
  /// Meaning of `restore` to the process `process` of `region`. `begun`: generation that the process computes in; 0: it
  /// has no world.
  RestoreMeaning meaning(const messages::RunCommand& restore, core::RegionId region, std::uint64_t process,
                         core::Generation generation, core::Generation begun) const;
  /// The argument of why_stand(). `silent`: neighbours whose streams have ended; counted only if the node's world is
  /// not from before a death (computes_in()).
  OwnWorld own_world(core::RegionId region, core::Generation generation, std::vector<core::RegionId> silent) const;
  /// True if a node that has begun `generation` computes in it, and no later one is about to begin.
  bool computes_in(core::Generation generation) const { return restoring_ <= generation; }
  /// Generation that the status names while the node waits.
  core::Generation waits_in() const { return waits_in_; }
  Clock::duration waited(Clock::time_point now) const { return now - since_; }

  /// A stop command was received. `waits`: while the node waits in a recovery. Then it does not wait for the others.
  void note_stop(bool waits) { stop_asked_ = waits; }
  bool stop_asked() const { return stop_asked_; }
  /// True if a stop breaks the recovery off. One that is about to succeed ends first, and all stop together soon after.
  bool is_stopped(Clock::time_point now) const;
  /// The run cannot go on before a user has decided something. Returns true if the question is new.
  bool ask(const std::string& question);
  /// The question to the user; empty: none.
  const std::string& question() const { return question_; }
  void forget_question() { question_.clear(); }

  /// The run ends before its time. The first reason counts. Returns true if this is the first.
  bool break_off(const std::string& why);
  bool is_broken_off() const { return !broken_off_.empty(); }
  const std::string& why_broken_off() const { return broken_off_; }

 private:
  std::optional<messages::RunCommand> restore_;  ///< the newest restore command
  core::Generation restoring_ = 0;               ///< generation that a recovery is about to begin, or has begun
  bool is_going_back_ = false;                   ///< all have agreed on restore_, and not all have begun
  core::Generation waits_in_ = 0;
  Clock::time_point since_;
  bool stop_asked_ = false;
  std::string question_;
  std::string broken_off_;
};

}  // namespace aurasim::process
