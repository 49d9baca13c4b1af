// Nodes on hosts whose network breaks and heals, in virtual time: what each hears of the others, how it stands, and how
// all go back. The decisions are those of the program (Fence, Recovery, why_stand, plan_restore, keepers_of, the
// roster); the world is a counter, and what DDS does is a rule: a status arrives where the link is whole, a node is
// lost after its lease, and is found again a moment after the link is whole.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "dds/node_roster.h"
#include "process/fence.h"
#include "process/recovery.h"
#include "process/restoration.h"

namespace aurasim::process::test {

using Time = std::chrono::steady_clock::time_point;

/// One direction between two hosts, or several, that do not work for a while.
struct Outage {
  Time begin, end;
  bool flaps = false;                                       ///< every other second they work
  std::set<std::pair<std::uint32_t, std::uint32_t>> links;  ///< from, to
};

enum class Phase : std::uint8_t { kRuns, kStands, kGathers, kConnects, kWaits, kTakesOver, kEnded };

class OutageSim {
 public:
  /// One node on each host.
  OutageSim(std::uint32_t hosts, std::uint64_t seed);
  ~OutageSim();

  void plan(Outage outage) { outages_.push_back(std::move(outage)); }
  void kill(std::uint32_t host, Time at) { kills_.push_back({host, at}); }
  void run_until(Time end);

  /// What must never be: empty as long as it was not.
  const std::string& broken() const { return broken_; }
  /// Empty: every region has one node, all of one generation, and all compute.
  std::string problem() const;
  /// States that all went back to.
  const std::vector<core::Step>& went_back_to() const { return went_back_to_; }
  core::Step newest_state() const;
  /// For a failure: what happened when.
  const std::string& story() const { return story_; }

  static constexpr core::Step kCheckpointSteps = 10;

 private:
  struct Process;
  struct Kill {
    std::uint32_t host;
    Time at;
  };

  bool passes(std::uint32_t from, std::uint32_t to) const;
  void deliver();
  void deliver(Process& from, Process& to);
  void act(Process& process);
  void compute(Process& process);
  void keep_part(Process& process);
  void stand(Process& process, const std::string& why);
  void agree(Process& process);
  void give_way(Process& process);
  void meet_anew(Process& process);
  void lead(Process& process, const SeenNodes& nodes);
  void go_back(Process& process);
  void begin(Process& process);
  void hear_of_restore(Process& process, const messages::RunCommand& restore);
  void start_stand_in(std::uint32_t host, core::RegionId region);
  SeenNodes nodes_of(Process& process) const;
  Process* sender_of(const Process& process, core::RegionId region) const;
  void tell(const Process& process, const std::string& what);

  std::uint32_t hosts_;
  std::mt19937_64 random_;
  Time now_{std::chrono::hours(1)};
  std::vector<std::unique_ptr<Process>> processes_;
  std::vector<Outage> outages_;
  std::vector<Kill> kills_;
  std::vector<messages::RunCommand> restores_;
  core::Generation newest_begun_ = 0;
  std::map<core::Generation, std::pair<std::uint64_t, core::RegionId>> begun_with_;  ///< node of region 0, and lead
  std::vector<core::Step> went_back_to_;
  std::string broken_, story_;
};

inline Time at(double seconds) {
  return Time(std::chrono::hours(1)) + std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

}  // namespace aurasim::process::test
