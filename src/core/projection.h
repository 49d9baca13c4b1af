// The publishing half of the protocol: follows every body through the phases of thesis 4.4 and turns what changed into
// aura creations (OBC), updates (OBU) and deletions (OBE). Checks that what was published came true.
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

/// What is remembered of a body that is hosted here.
struct Track {
  BodyId id{};
  Epoch epoch = 0;
  Phase phase = Phase::kInjected;
  bool too_fast = false;     ///< already counted
  bool out_of_span = false;  ///< already counted
  Step island_since = -1;    ///< first of the states in a row in which its cluster was an island; -1: is none
  struct Published {
    AuraRecord newest;
    AuraRecord promise;  ///< an older one, kept until what it promised can be checked
  };
  std::unique_ptr<Published> published;  ///< its auras, while the other regions have one
  bool projected() const { return published != nullptr; }
};

/// Counted since the start; one per aura and message.
struct ProjectionCounters {
  std::uint64_t created = 0;
  std::uint64_t updated = 0;
  std::uint64_t deleted = 0;
  std::uint64_t bad_phase_changes = 0;  ///< transitions that the state machine does not have: our own bug
};

class Projection {
 public:
  Projection(const Aura& aura, const Vicinity& vicinity) : aura_(aura), vicinity_(vicinity) {}

  /// Lines the tracks up with the bodies of a state: new bodies start as kInjected.
  void follow(const Snapshot& snapshot);

  Track& track(std::uint32_t i) { return tracks_[i]; }
  /// Nothing if the body is not hosted here (as of the last state).
  const Track* find(BodyId id) const;

  /// Moves every body to the phase that its place asks for.
  void classify(const Snapshot& snapshot, const InterestMatching& matching);

  /// Writes creations, updates and deletions of the bodies that stay into `batch`; `full`: all that are projected.
  void publish(const Snapshot& snapshot, const InterestMatching& matching, AuraBatch& batch, ViolationLog& violations,
               bool full);

  /// Body i leaves for `destination`: the others keep its last aura, as a ghost, for 2K steps.
  void depart(const BodyState& body, std::uint32_t i, const Clusters& clusters, RegionId destination, PhaseEvent why,
              AuraBatch& batch);

  std::span<const AuraRecord> ghosts() const { return ghosts_; }
  std::size_t projecting() const { return projecting_; }
  const ProjectionCounters& counters() const { return counters_; }

 private:
  void move(Track& track, PhaseEvent event);
  void publish(Track& track, const AuraRecord& aura, AuraBatch& batch, bool full);
  void note_gone(const Track& track);
  void take_back_gone(AuraBatch& batch);
  void keep_newest_ghosts();
  void expire_ghosts(const Snapshot& snapshot, AuraBatch& batch);
  AuraRecord describe(const BodyState& body, std::uint32_t i, const Clusters& clusters, Step stamp) const;
  void check_promise(Track& track, const BodyState& body, Step now, ViolationLog& violations);
  void check_speed(Track& track, const BodyState& body, Step now, ViolationLog& violations);
  void check_span(Track& track, const BodyState& body, Step now, ViolationLog& violations);

  const Aura& aura_;
  const Vicinity& vicinity_;
  std::vector<Track> tracks_, before_;  ///< ascending id
  std::vector<BodyId> ids_;             ///< of tracks_, close together: for looking them up
  std::vector<AuraRecord> ghosts_;
  std::vector<BodyId> gone_;  ///< projected in the last state, not hosted any longer, not sent either
  std::size_t projecting_ = 0;
  ProjectionCounters counters_;
};

}  // namespace aurasim::core
