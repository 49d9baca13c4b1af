// Arranges patches or joints ("entries"), each between two bodies, in blocks of lanes. They are solved phase by phase
// (soft/seams.h). The groups of a phase share no body, so each thread solves whole groups, in colours: entries of one
// colour share no body that moves. Groups that are too heavy for one thread are solved by all of them, colour by
// colour. Within a colour, entries are grouped by kind.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/seams.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {

/// The load of a sweep, in contact points and patches.
struct SoftLoad {
  std::uint64_t all = 0;
  std::uint64_t split = 0;  ///< of groups that all threads solve together, colour by colour
};

class SoftLayout {
 public:
  /// When threads wait for each other.
  enum class Waits {
    kInEachPhase,  ///< groups of different phases may share bodies
    kOnceForAll,   ///< no two groups share a body, in whatever phases
  };

  explicit SoftLayout(Waits waits) : stages_(waits == Waits::kOnceForAll ? 1 : kAllPhases) {}

  /// Starts anew. `movers`: number of movers; `kinds`: number of kinds of entries.
  void clear(std::size_t movers, std::size_t kinds, std::size_t entries);
  /// Sets the i-th entry, between two movers; 0 and below are statics. The entries of an island have to come in an
  /// order that follows from the island alone, and so do the colours. No colour has entries of two phases. Entries with
  /// statics have a phase of their own, which is solved last, because statics cannot give way. Entries that share a
  /// body in a phase have the same `group`, below kSoftGroups; others may have. Several threads may set different
  /// entries.
  void put(std::size_t i, std::int32_t a, std::int32_t b, std::size_t kind, SoftPhase phase, std::size_t group);
  /// Places all entries in blocks. Returns the number of blocks.
  std::size_t place(soft::Team& team);

  std::size_t size() const { return entries_.size(); }
  /// Mover a of the i-th entry.
  std::int32_t a(std::size_t i) const { return entries_[i].a; }
  std::int32_t b(std::size_t i) const { return entries_[i].b; }
  std::size_t block(std::size_t i) const;
  int lane(std::size_t i) const;
  const SoftLoad& load() const { return load_; }

  /// Goes through all entries in the order of a sweep, `times` times: calls work(time, first block, number of blocks,
  /// kind) for this worker's part. All workers have to call it; it returns when all are done. With kOnceForAll, a
  /// worker goes through its groups `times` times before it waits.
  template <class Work>
  void sweep(const soft::Worker& worker, int times, Work&& work) const {
    for (std::size_t stage = 0; stage < stages_; ++stage) sweep(stage, worker, times, work);
  }
  /// One sweep with kInEachPhase, but before each phase, also an empty one, one worker calls before(phase), while the
  /// others wait.
  template <class Work, class Before>
  void sweep_after(const soft::Worker& worker, Work&& work, Before&& before) const {
    for (std::size_t stage = 0; stage < stages_; ++stage) {
      if (worker.is_first() && stage < kStatics) before(static_cast<SoftPhase>(stage));
      if (is_empty_[stage]) continue;
      worker.wait();
      sweep(stage, worker, 1, work);
    }
  }

 private:
  static constexpr std::size_t kStatics = kSoftPhases;  ///< phase of the entries with statics
  static constexpr std::size_t kAllPhases = kSoftPhases + 1;
  static constexpr std::size_t kColours = 65;  ///< the last one: no colour was free

  struct Entry {
    std::int32_t a, b;  ///< movers
    std::uint16_t kind;
    std::uint16_t group;
    std::uint8_t phase, colour;
    std::uint8_t part;    ///< index in parts_
    std::uint32_t place;  ///< block * lanes + lane
  };
  /// Blocks of one colour and kind.
  struct Run {
    std::size_t first, count, kind;
    bool in_order;  ///< no free colour was left: entries may share bodies
    bool ends;      ///< the last run of its colour
  };
  /// What one thread solves, or all of them together (the first part).
  struct alignas(64) Part {
    std::vector<std::uint32_t> next;                ///< by row: number of entries, then the next free place
    std::array<std::size_t, kAllPhases> colours{};  ///< by phase: number of colours
    std::vector<Run> runs;
    std::array<std::size_t, kAllPhases + 1> first_run{};  ///< by stage
  };
  /// By phase and group.
  using Costs = std::array<std::array<std::uint32_t, kSoftGroups>, kAllPhases>;

  template <class Work>
  void sweep(std::size_t stage, const soft::Worker& worker, int times, Work&& work) const {
    if (is_empty_[stage]) return;
    for (int time = 0; time < times; ++time) {
      for (const Run& run : runs_of(0, stage)) {
        const auto [first, last] = (run.in_order ? soft::Worker{} : worker).share(run.count);
        if (first < last && (!run.in_order || worker.is_first())) work(time, run.first + first, last - first, run.kind);
        if (run.ends) worker.wait();
      }
    }
    for (int time = 0; time < times; ++time) {
      for (const Run& run : runs_of(static_cast<std::size_t>(worker.number) + 1, stage)) {
        work(time, run.first, run.count, run.kind);
      }
    }
    worker.wait();
  }
  std::size_t stage_of(std::size_t phase) const { return stages_ > 1 ? phase : 0; }
  std::size_t row_of(const Entry& entry) const { return (entry.phase * kColours + entry.colour) * kinds_ + entry.kind; }
  std::span<const Run> runs_of(std::size_t part, std::size_t stage) const {
    const Part& of = parts_[part];
    return std::span(of.runs).subspan(of.first_run[stage], of.first_run[stage + 1] - of.first_run[stage]);
  }
  void add_up(const soft::Worker& worker);
  void share_out(std::size_t threads);
  void share_out(std::size_t stage, std::size_t threads);
  bool share_out_in_order(std::size_t stage, std::size_t threads, std::uint64_t rest);
  void colour(const soft::Worker& worker);
  std::uint8_t free_colour(const Entry& entry);
  void count(Part& part, const Entry& entry);
  void count_split();
  std::size_t make_runs(std::size_t threads);
  std::size_t make_runs(Part& part, std::size_t phase, std::size_t blocks);
  void place_part(std::size_t part);

  std::size_t stages_;
  std::size_t kinds_ = 1;
  std::size_t movers_ = 0;
  std::vector<Entry> entries_;
  /// by phase and mover: bits of its colours
  std::array<std::vector<std::uint64_t>, kAllPhases> used_;
  std::vector<Costs> costs_;                                                 ///< by thread; the first one: of all
  std::array<std::array<std::uint8_t, kSoftGroups>, kAllPhases> part_of_{};  ///< by stage and group
  std::vector<std::uint16_t> groups_;        ///< of a stage, without those that are split
  std::vector<std::uint64_t> loads_;         ///< by thread
  std::array<bool, kAllPhases> is_empty_{};  ///< by stage
  std::vector<Part> parts_;
  SoftLoad load_;
};

}  // namespace aurasim::physics
