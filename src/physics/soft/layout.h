// Arranges patches or joints ("entries"), each between two bodies, in blocks of lanes. They are solved phase by phase
// (soft/seams.h), in colours: entries of one colour share no body that moves. Within a colour they are grouped by kind.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/soft/seams.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {

class SoftLayout {
 public:
  /// Starts anew. `movers`: number of movers; `kinds`: number of kinds of entries.
  void clear(std::size_t movers, std::size_t kinds);
  /// Adds an entry between two movers; 0 and below are statics. The entries of an island have to come in an order that
  /// follows from the island alone, and so do the colours. No colour has entries of two phases. Entries with statics
  /// have a phase of their own, which is solved last, because statics cannot give way.
  void add(std::int32_t a, std::int32_t b, std::size_t kind, SoftPhase phase = SoftPhase::kInside);
  /// Places all added entries in blocks. Returns the number of blocks.
  std::size_t place();

  std::size_t size() const { return entries_.size(); }
  /// Mover a of the i-th added entry.
  std::int32_t a(std::size_t i) const { return entries_[i].a; }
  std::int32_t b(std::size_t i) const { return entries_[i].b; }
  std::size_t block(std::size_t i) const;
  int lane(std::size_t i) const;

  /// Calls work(first block, number of blocks, kind) for this worker's share of each run. All workers have to call it;
  /// it returns when all are done.
  template <class Work>
  void for_each_run(const soft::Worker& worker, Work&& work) const {
    for (const Run& run : runs_) {
      const soft::Worker alone;
      const auto [first, last] = (run.in_order ? alone : worker).share(run.count);
      if (first < last && (!run.in_order || worker.is_first())) work(run.first + first, last - first, run.kind);
      if (run.ends) worker.wait();
    }
  }

 private:
  static constexpr std::size_t kStatics = kSoftPhases;  ///< phase of the entries with statics

  struct Entry {
    std::int32_t a, b;  ///< movers
    std::uint16_t kind;
    std::uint8_t phase, colour;
    std::uint32_t place;  ///< block * lanes + lane
  };
  /// Blocks of one colour and kind.
  struct Run {
    std::size_t first, count, kind;
    bool in_order;  ///< no free colour was left: entries may share bodies
    bool ends;      ///< the last run of its colour
  };

  std::size_t row_of(const Entry& entry) const {
    return (first_colour_[entry.phase] + entry.colour) * kinds_ + entry.kind;
  }

  std::size_t kinds_ = 1;
  std::size_t movers_ = 0;
  std::vector<Entry> entries_;  ///< in the order of add()
  /// by phase and mover: bits of its colours; those with statics lie above those of the first phase
  std::array<std::vector<std::uint64_t>, kSoftPhases> used_;
  std::array<std::size_t, kSoftPhases + 1> colours_{};       ///< by phase: number of colours
  std::array<std::size_t, kSoftPhases + 1> first_colour_{};  ///< by phase: number of the colours of earlier phases
  std::vector<std::uint32_t> next_;                          ///< by colour and kind: next free place
  std::vector<Run> runs_;
};

}  // namespace aurasim::physics
