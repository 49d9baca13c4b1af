// What holds two bodies, in blocks of lanes: in colours, so that those of a colour share no body that moves, and within
// a colour by kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "physics/soft/threads.h"

namespace aurasim::physics {

class SoftLayout {
 public:
  /// `kinds`: how many there are. Of bodies that are all movers below `movers`.
  void clear(std::size_t movers, std::size_t kinds);
  /// Between two movers; 0 and below are statics. Those of an island in an order that follows from the island alone: so
  /// do the colours. Those of statics have colours of their own, which come last: what cannot give way has the last
  /// word.
  void add(std::int32_t a, std::int32_t b, std::size_t kind);
  /// Of all that were added. Returns the number of blocks.
  std::size_t place();

  std::size_t size() const { return entries_.size(); }
  /// Of the i-th that was added.
  std::int32_t a(std::size_t i) const { return entries_[i].a; }
  std::int32_t b(std::size_t i) const { return entries_[i].b; }
  std::size_t block(std::size_t i) const;
  int lane(std::size_t i) const;

  /// work(first block, blocks, kind), by each worker for its share; when it returns, all have done theirs.
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
  struct Entry {
    std::int32_t a, b;    ///< movers
    std::uint32_t kind;   ///< colour * kinds + kind
    std::uint32_t place;  ///< block * lanes + lane
  };
  /// Blocks of one colour and kind.
  struct Run {
    std::size_t first, count, kind;
    bool in_order;  ///< they have no colour, and may share bodies
    bool ends;      ///< its colour
  };

  std::size_t kinds_ = 1;
  std::vector<Entry> entries_;       ///< as they came
  std::vector<std::uint64_t> used_;  ///< colours, by mover
  std::vector<std::uint32_t> next_;  ///< by colour and kind
  std::vector<Run> runs_;
};

}  // namespace aurasim::physics
