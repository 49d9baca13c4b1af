// Keeps account of which regions have their parts of a saved world on disk. A world is whole once all have, and only
// then the world that it replaces may be removed. Once one region could not write its part, the other parts are of no
// use. Touches no files; time is passed in.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/ids.h"

namespace aurasim::cut {

enum class SaveFate { kWhole, kFailed };

class SaveLedger {
 public:
  using Clock = std::chrono::steady_clock;

  SaveLedger(core::RegionId self, std::size_t regions) : self_(self), regions_(regions) {}

  /// This region's part of the save is being written.
  void begin(std::uint64_t save) { open_.push_back({save, {}, {}, {}}); }
  /// Notes that this region's part is on disk, or could not be written.
  void note_own(std::uint64_t save, bool is_written);
  /// Notes what another region's status contains about its own parts (dds::Status). Every status repeats it.
  void receive(core::RegionId region, const std::vector<std::uint64_t>& saved,
               const std::vector<std::uint64_t>& not_saved);
  /// Forgets a save whose outcome does not matter any more.
  void forget(std::uint64_t save);

  struct Outcome {
    std::uint64_t save = 0;
    SaveFate fate = SaveFate::kWhole;
    std::vector<core::RegionId> without;  ///< regions that could not write their parts
  };
  /// Saves that have come to an end since the last call, in the order in which they began.
  std::vector<Outcome> take_outcomes(Clock::time_point now);

  /// For the status: the newest parts of this region that are on disk, and those that could not be written.
  std::vector<std::uint64_t> saved() const { return {saved_.begin(), saved_.end()}; }
  std::vector<std::uint64_t> not_saved() const { return {not_saved_.begin(), not_saved_.end()}; }

 private:
  struct Open {
    std::uint64_t save = 0;
    std::set<core::RegionId> has, without;
    std::optional<Clock::time_point> failed_since;
  };
  Open* find(std::uint64_t save);

  core::RegionId self_;
  std::size_t regions_;
  std::vector<Open> open_;
  std::deque<std::uint64_t> saved_, not_saved_;
};

}  // namespace aurasim::cut
