// How the nodes go back to a state that is kept, after a death or because a client asks for it: each gets the parts of
// all regions, puts the world together, and computes on from there.
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "process/world_gathering.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kRestoreRound = 5ms;
constexpr auto kPatienceWithParts = 10s;

}  // namespace

/// Goes back to the state that the newest restore names. Throws SomebodyDied when a node dies meanwhile.
void NodeProcess::go_back() {
  restoration_.go_back();
  const messages::RunCommand restore = *restoration_.restore();
  take_map_of(restore);
  WorldGathering gathering({launch_, options_, saving_, checkpoints(), node_.get()}, restore);
  auto deadline = Clock::now() + kPatienceWithParts;
  gathering.send_parts();
  while (!gathering.has_all_parts()) wait_in_recovery(deadline, "the parts of the world");
  gathering.send_orders();
  while (!gathering.has_all_orders()) wait_in_recovery(deadline, "the orders that others know");
  const core::WorldCut world = gathering.take_world();
  start_.await(restore.generation);
  deadline = Clock::now() + kPatienceWithParts;
  begin_to_connect(transport_settings());
  while (const char* const missing = go_on_connecting()) wait_in_recovery(deadline, missing);
  begin_restored(restore, world, gathering.parts());
  restoration_.finish();
}

/// Takes the scene and the regions that the run goes on with from the published map.
void NodeProcess::take_map_of(const messages::RunCommand& restore) {
  const messages::WorldMap* map = nullptr;
  const auto deadline = Clock::now() + kPatienceWithParts;
  while (map == nullptr) {
    for (const auto& [version, known] : control().maps()) {
      const bool agrees = known.agreement == status_.content().agreement;
      if (known.generation == restore.generation && agrees) map = &known;
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
  if (restoration_.is_broken_off()) throw SomebodyDied(restoration_.why_broken_off());
  if (Clock::now() > deadline) throw SomebodyDied(fmt::format("waited in vain for {}", for_what));
  execute_commands();
  look_for_deaths();
  publish();
  control().wait(kRestoreRound);
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
  const bool is_sender = restore.region == options_.region;
  schedule_.go_back(restore, is_sender, first_step(), node::read_clocks());
  fence_.begin_anew();
  checkpoints().go_back(restore.era, restore.at_step, parts);
  status_.content().era = restore.era;
  begin_with(node_->start(world, from_first ? node::Recorded::kNo : node::Recorded::kYes));
  const double waited_s = std::chrono::duration<double>(restoration_.waited(Clock::now())).count();
  const std::string news = fmt::format("went back to state {} after {:.2f} s", node_->current_step(), waited_s);
  spdlog::info("region {} {}", core::value_of(options_.region), news);
  notices_.note_news(news);
}

}  // namespace aurasim::process
