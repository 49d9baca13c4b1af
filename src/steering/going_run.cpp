#include "steering/going_run.h"

#include <algorithm>
#include <chrono>

#include "dds/control.h"
#include "host/stop_signal.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"

namespace aurasim::steering {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 3s;  // nodes are found in a fraction of a second, by way of a discovery server in one

struct Ear {
  Ear(const config::Launch& launch, const std::string& as, core::RegionId region)
      : participant(setup::with_keys(setup::dds_settings(launch), launch, setup::member_for_node(launch, as, region))),
        control(participant, {.agreement = launch.agreement(),
                              .region_count = static_cast<std::uint32_t>(launch.regions.size()),
                              .only_watches = true}) {}

  dds::Participant participant;
  dds::ControlBus control;
};

}  // namespace

bool goes_on(const std::map<core::RegionId, messages::SeenStatus>& statuses) {
  return std::ranges::any_of(statuses, [](const auto& entry) {
    const messages::SeenStatus& seen = entry.second;
    const messages::NodeState state = seen.status.state;
    return seen.is_live() && state != messages::NodeState::kStarting && state != messages::NodeState::kWaiting;
  });
}

bool a_run_goes_on(const config::Launch& launch, const std::string& as, core::RegionId region) {
  Ear& ear = *new Ear(launch, as, region);
  for (const auto end = Clock::now() + kPatience; Clock::now() < end && !host::stop_requested();
       ear.control.wait(50ms)) {
    if (goes_on(ear.control.statuses())) return true;
  }
  return false;
}

}  // namespace aurasim::steering
