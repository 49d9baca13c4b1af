// How the nodes go back to a state that is kept, after a death or because a client asks for it: each gets the parts of
// all regions, puts the world together, and computes on from there.
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "cut/saved_world.h"
#include "host/stop_signal.h"
#include "process/node_process.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Kind = messages::Checkpoint::Kind;

constexpr auto kRestoreRound = 5ms;
constexpr auto kPatienceWithParts = 10s;

}  // namespace

/// Goes back to the state that the restore names. Throws SomebodyDied when a node dies meanwhile.
void NodeProcess::go_back(const messages::RunCommand& restore) {
  restoring_ = restore.generation;
  is_going_back_ = true;
  take_map_of(restore);
  std::map<core::RegionId, std::string> parts;
  const core::WorldCut world = gather(restore, parts);
  waits_to_start_ = restore.generation;
  const auto deadline = Clock::now() + kPatienceWithParts;
  connect_anew(transport_settings(), [&](const char* for_what) { wait_in_recovery(deadline, for_what); });
  begin_restored(restore, world, parts);
  is_going_back_ = false;
}

/// Takes the scene and the regions that the run goes on with from the published map.
void NodeProcess::take_map_of(const messages::RunCommand& restore) {
  const messages::WorldMap* map = nullptr;
  const auto deadline = Clock::now() + kPatienceWithParts;
  while (map == nullptr) {
    for (const auto& [version, known] : control().maps()) {
      if (known.generation == restore.generation && known.agreement == status_.content().agreement) map = &known;
    }
    if (map == nullptr) wait_in_recovery(deadline, "the map");
  }
  if (map->scene != launch_.scene.name) launch_ = config::with_scene(launch_, map->scene);
  if (map->map_version != launch_.regions.version()) launch_ = config::with_regions(launch_, map->regions);
  status_.use_regions(launch_);
  control().use_map(launch_.regions.version());
  endpoints_.open_ros2();
  endpoints_.serve_map();
}

void NodeProcess::wait_in_recovery(Clock::time_point deadline, const char* for_what) {
  if (host::stop_requested()) throw SomebodyDied("told to stop");
  if (fence_.closed()) throw SomebodyDied(fence_.reason());
  if (!broken_off_.empty()) throw SomebodyDied(broken_off_);
  if (Clock::now() > deadline) throw SomebodyDied(fmt::format("waited in vain for {}", for_what));
  execute_commands();
  look_for_deaths();
  publish();
  control().wait(kRestoreRound);
}

/// Puts the world together from all parts, with all orders that any node knows by now.
core::WorldCut NodeProcess::gather(const messages::RunCommand& restore, std::map<core::RegionId, std::string>& parts) {
  const bool from_first = restore.count == 1;
  const std::size_t regions = launch_.regions.size();
  const auto deadline = Clock::now() + kPatienceWithParts;
  const auto give = [&](core::RegionId region, Kind kind, const std::string& octets) {
    checkpoints().give({region, kind, restore.generation, restore.at_step, octets});
  };
  core::WorldCut whole;
  if (from_first) {
    whole = options_.world ? *options_.world : node::first_world(launch_.scene, launch_.lookahead(), launch_.step_s());
  } else {
    for (std::uint32_t r = 0; r < regions; ++r) {
      const core::RegionId region{r};
      if (restore.members[r].holder != options_.region) continue;
      if (const std::string* octets = checkpoints().find(region, restore.at_step)) give(region, Kind::kGoBack, *octets);
    }
    while (checkpoints().given(restore.generation, Kind::kGoBack).size() < regions) {
      wait_in_recovery(deadline, "the parts of the world");
    }
    parts = checkpoints().given(restore.generation, Kind::kGoBack);
    std::vector<core::WorldCut> cuts;
    for (const auto& [region, octets] : parts) cuts.push_back(decode_part(octets));
    whole = core::merge(std::move(cuts));
  }
  std::size_t survivors = 0;
  for (const messages::RunCommand::Member& member : restore.members) survivors += member.survives;
  if (restore.members.at(core::value_of(options_.region)).survives && node_) {
    give(options_.region, Kind::kOrders, cut::encode(saving_.as_saved(node_->orders_now(whole))));
  }
  while (checkpoints().given(restore.generation, Kind::kOrders).size() < survivors) {
    wait_in_recovery(deadline, "the orders that others know");
  }
  std::vector<core::WorldCut> all = {std::move(whole)};
  for (const auto& [region, octets] : checkpoints().given(restore.generation, Kind::kOrders)) {
    all.push_back(decode_part(octets));
  }
  return core::merge(std::move(all));
}

core::WorldCut NodeProcess::decode_part(const std::string& octets) const {
  cut::SavedWorld part = cut::decode(octets);
  const std::string differs = cut::check_identity("checkpoint", part.identity, cut::identity_of(launch_), true);
  if (!differs.empty()) spdlog::warn("region {}: {}: bits may differ", core::value_of(options_.region), differs);
  return std::move(part.cut);
}

/// Opens the records to go on after state `step`. The run goes on even if that fails.
void NodeProcess::record_after(std::optional<core::Step> step) {
  const std::string problem = records_.go_on_after(step);
  if (!problem.empty()) notices_.note_fault(fmt::format("nothing is recorded from here on: {}", problem));
}

void NodeProcess::begin_restored(const messages::RunCommand& restore, const core::WorldCut& world,
                                 const std::map<core::RegionId, std::string>& parts) {
  const bool from_first = restore.count == 1;
  node_ = make_node();
  life_of_node_ = life_;
  endpoints_.commands().go_back(*node_, generation_);
  record_after(from_first ? std::nullopt : std::optional(restore.at_step));
  pacer_.set_rate(restore.rate, restore.at_step, restore.epoch_ns, restore.clock_ahead, node::read_clocks());
  status_.content().rate = restore.rate;
  fence_.begin_anew();
  checkpoints().go_back(restore.era, restore.at_step, parts);
  status_.content().era = restore.era;
  reset_.reset();
  if (restore.region != options_.region) hold_at_.reset();  // the node that sent the restore repeats the pause
  if (began_ == Clock::time_point{}) began_ = pacer_.due(first_step());
  begin_with(node_->start(world, from_first ? node::Recorded::kNo : node::Recorded::kYes));
  const double stood_s = std::chrono::duration<double>(Clock::now() - recovering_since_).count();
  const std::string news = fmt::format("went back to state {} after {:.2f} s", node_->current_step(), stood_s);
  spdlog::info("region {} {}", core::value_of(options_.region), news);
  notices_.note_news(news);
}

}  // namespace aurasim::process
