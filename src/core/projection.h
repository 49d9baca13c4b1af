// The publishing half of the protocol: follows every body through the phases of thesis 4.4 and turns what changed into
// aura creations (OBC), updates (OBU) and deletions (OBE). Checks that bodies are where their auras promised.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/body_phase.h"
#include "core/interest_matching.h"
#include "core/messages.h"
#include "core/vicinity.h"
#include "core/violation.h"

namespace aurasim::core {

/// State of the projection for one body hosted here.
struct Track {
  BodyId id{};
  Epoch epoch = 0;
  Phase phase = Phase::kInjected;
  bool too_fast = false;               ///< kSpeed violation already counted
  bool out_of_span = false;            ///< kSpan violation already counted
  Audience audience = kNobodyListens;  ///< regions to which its aura goes
  Step island_since = -1;  ///< first of the consecutive states in which its cluster was an island; -1: is none
  struct Published {
    AuraRecord newest;
    AuraRecord promise;  ///< an older aura, kept until its promise can be checked
  };
  std::unique_ptr<Published> published;  ///< its auras while the body projects
  bool projected() const { return published != nullptr; }
};

/// Auras in batches, counted since the start.
struct ProjectionCounters {
  std::uint64_t created = 0;
  std::uint64_t updated = 0;
  std::uint64_t deleted = 0;
  std::uint64_t bad_phase_changes = 0;  ///< transitions that the state machine does not have: our own bug
};

class Projection {
 public:
  Projection(const Aura& aura, const Vicinity& vicinity) : aura_(aura), vicinity_(vicinity) {}

  /// By index of the last snapshot.
  Track& track(std::uint32_t i) { return tracks_[i]; }
  const Track& track(std::uint32_t i) const { return tracks_[i]; }

  /// Matches the tracks to the bodies of a state; new bodies start as kInjected. Moves each body to the phase that
  /// follows from its place, and decides to whom its aura goes. Bodies that are deep inside, as they were before, are
  /// not looked at.
  void classify(const Snapshot& snapshot, const InterestMatching& matching);

  /// Writes creations, updates and deletions of the bodies that stay into `batch`; `full`: writes all projected auras,
  /// not only changed ones.
  void publish(const Snapshot& snapshot, AuraBatch& batch, ViolationLog& violations, bool full);

  /// Body i leaves for `destination`. Its last aura stays published as a ghost for 2K steps.
  void depart(const BodyState& body, std::uint32_t i, RegionId destination, PhaseEvent why, AuraBatch& batch);

  std::span<const AuraRecord> ghosts() const { return ghosts_; }
  std::size_t projecting() const { return projecting_; }
  const ProjectionCounters& counters() const { return counters_; }

 private:
  void move(Track& track, PhaseEvent event);
  void publish(Track& track, const AuraRecord& aura, AuraBatch& batch, bool full);
  void follow(const Snapshot& snapshot);
  void note_gone(const Track& track);
  void classify(std::uint32_t i, const InterestMatching& matching);
  void note_busy(const InterestMatching& matching);
  void take_back_gone(AuraBatch& batch);
  void keep_newest_ghosts();
  void expire_ghosts(const Snapshot& snapshot, AuraBatch& batch);
  AuraRecord describe(const BodyState& body, Audience audience, Step stamp) const;
  void check_promise(Track& track, const BodyState& body, Step now, ViolationLog& violations);
  void check_speeds(const Snapshot& snapshot, ViolationLog& violations);
  void check_speed(Track& track, const BodyState& body, Step now, ViolationLog& violations);
  void check_span(Track& track, const BodyState& body, Step now, ViolationLog& violations);

  const Aura& aura_;
  const Vicinity& vicinity_;
  std::vector<Track> tracks_, before_;  ///< ascending id
  bool goes_on_ = false;                ///< the last snapshot has named what differs from the one before
  std::vector<std::uint32_t> busy_;     ///< bodies that may project, or have; ascending
  std::vector<std::uint32_t> were_busy_;
  std::vector<AuraRecord> ghosts_;
  std::vector<BodyId> gone_;  ///< projected in the last state, no longer hosted, and not handed over
  std::size_t projecting_ = 0;
  ProjectionCounters counters_;
};

}  // namespace aurasim::core
