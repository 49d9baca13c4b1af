// The one place where a simulation notes which bodies it has changed. Each reader looks at the changed ones only, so a
// sleeper costs nothing. A change that is not noted here is missing in snapshots, hashes and copies.
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/body_state.h"
#include "core/keep_one_of_each.h"
#include "physics/changed_bodies.h"

namespace aurasim::physics {

/// Two objects that have touched since a copy was made; ascending.
using TouchedPair = std::pair<core::ObjectRef, core::ObjectRef>;

struct StateNotes {
  StateNotes() { for_borders.note_all(); }

  ChangedBodies for_snapshot;      ///< since the last snapshot
  bool others = false;             ///< since the last snapshot, bodies have come, gone or been born
  std::vector<core::BodyId> came;  ///< those that have come or been born
  ChangedBodies for_hash;          ///< since the last hash
  ChangedBodies for_step;          ///< since the last step began, and in it
  ChangedBodies for_borders;       ///< since a coupled world last looked for bodies near borders; else always all
  ChangedBodies for_copy;          ///< since the copy that later ones share
  ChangedBodies parted;            ///< since that copy: the contacts of these bodies may have changed
  std::vector<TouchedPair> pairs;  ///< since that copy: all pairs of a body of `parted` that are in contact are here
  std::size_t known_pairs = 0;     ///< length of `pairs` when it was last sorted

  /// A body's pose, velocity or activation state may have changed.
  void note(core::BodyId id) {
    for_snapshot.note(id);
    for_hash.note(id);
    for_step.note(id);
    for_borders.note(id);
    for_copy.note(id);
  }
  void note_block(core::BodyId id) {
    for_hash.note(id);
    for_borders.note(id);
    for_copy.note(id);
  }
  /// All bodies, contacts and joints may have changed.
  void note_all() {
    for (ChangedBodies* reader : {&for_snapshot, &for_hash, &for_step, &for_borders}) reader->note_all();
    give_up_copy();
  }
  /// A body has come, or is born.
  void note_new(core::BodyId id) {
    for_snapshot.note(id);
    others = true;
    came.push_back(id);
    for_hash.note(id);
    for_step.note(id);
    for_borders.note(id);
    for_copy.note(id);
    parted.note(id);
  }
  void note_gone(core::BodyId id) {
    for_snapshot.note(id);
    others = true;
    for_copy.note(id);
    parted.note(id);
  }
  /// The last step has computed these bodies, ascending.
  void note_moved(std::span<const core::BodyId> ids) {
    for (ChangedBodies* reader : {&for_snapshot, &for_hash, &for_step, &for_borders, &for_copy, &parted}) {
      reader->note(ids);
    }
  }
  /// Does a reader want the contacts of the bodies that the last step has computed?
  bool wants_contacts() const { return !for_snapshot.all() || !parted.all(); }
  void note_pair(core::ObjectRef a, core::ObjectRef b) {
    if (parted.all()) return;
    pairs.emplace_back(std::min(a, b), std::max(a, b));
    if (pairs.size() > 2 * known_pairs + 256) sort_pairs();
  }

  void free_spare_memory() {
    for (ChangedBodies* reader : {&for_snapshot, &for_hash, &for_step, &for_copy, &parted}) reader->free_spare_memory();
    pairs.shrink_to_fit();
  }

  /// No copy is shared any more.
  void give_up_copy() {
    for_copy.note_all();
    parted.note_all();
    pairs.clear();
    known_pairs = 0;
  }
  /// A copy has been made that later ones share.
  void begin_copy() {
    for_copy.clear();
    parted.clear();
    pairs.clear();
    known_pairs = 0;
  }
  void sort_pairs() {
    core::keep_one_of_each(pairs);
    known_pairs = pairs.size();
  }
};

}  // namespace aurasim::physics
