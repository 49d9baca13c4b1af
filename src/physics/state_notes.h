// The one place where a simulation notes which bodies it has changed. Each reader looks at the changed ones only, so a
// sleeper costs nothing. A change that is not noted here is missing in snapshots and hashes.
#pragma once

#include "physics/changed_bodies.h"

namespace aurasim::physics {

struct StateNotes {
  ChangedBodies for_snapshot;  ///< since the last snapshot; all: bodies have come, gone or been born
  ChangedBodies for_hash;      ///< since the last hash
  ChangedBodies for_step;      ///< since the last step began, and in it

  /// A body's pose, velocity, activation state or block may have changed.
  void note(core::BodyId id) {
    for_snapshot.note(id);
    for_hash.note(id);
    for_step.note(id);
  }
  /// All bodies may have changed.
  void note_all() {
    for_snapshot.note_all();
    for_hash.note_all();
    for_step.note_all();
  }
  /// A body has come, or is born.
  void note_new(core::BodyId id) {
    for_snapshot.note_all();
    for_hash.note(id);
    for_step.note(id);
  }
  void note_gone() { for_snapshot.note_all(); }
};

}  // namespace aurasim::physics
