// Composes the JSON messages to the page (docs/viewer.md).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/order.h"
#include "core/region_map.h"
#include "core/scene.h"
#include "dds/control.h"
#include "overseer/world_frame.h"

namespace aurasim::overseer {

struct Hello {
  bool replay = false;
  std::string scene;
  double step_s = 0;
  double tick_hz = 0;
  core::Step first = 0;  ///< first place in the replay
  core::Step last = 0;
  std::vector<core::Step> resets;  ///< places in the replay at which the run was reset
};
std::string hello_message(const Hello& hello);

/// Describes a scene. `removed`: statics that do not exist any more; the others keep their ids.
std::string scene_message(const core::Scene& scene, core::Generation generation,
                          const std::set<core::StaticId>& removed);
/// Describes where moved statics go (MoveStatic orders, ascending): all that the page has to know now.
std::string moves_message(core::Generation generation, std::span<const core::Order> moves);
std::string map_message(const core::RegionMap& map);

struct RunStatus {
  core::Step step = 0;
  std::string state;
  double rate = 1;
  std::uint64_t clients = 0;
  std::map<core::RegionId, messages::SeenStatus> nodes;
  std::map<core::RegionId, double> hand_offs_per_s;
};
std::string status_message(const RunStatus& status);
/// Metrics of the nodes in the format of Prometheus.
std::string node_metrics(const RunStatus& status);

std::string body_message(const ViewBody& body);
std::string body_gone_message(core::BodyId id);

}  // namespace aurasim::overseer
