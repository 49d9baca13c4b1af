// What happens to a world in mid-run: interference.json beside its launch file.
//   {"shuffle_ranks_steps": 30,
//    "orders": [{"at_step": 120, "remove_body": 7},
//               {"at_step": 90, "spawn": {"id": 1000000001, "prototype": "box_3", "position": [..], "velocity": [..]}},
//               {"at_step": 95, "spawn": {"id": 1000000002, "sphere": {"radius": 0.2}, "mass": 3, ...}},
//               {"at_step": 150, "impulse": {"body": 3, "value": [..]}},
//               {"at_step": 150, "set_velocity": {"body": 3, "value": [..], "spin": [..]}},
//               {"at_step": 200, "add_static": {"name": "wall_0", "box": {"size": [..]}, "position": [..]}},
//               {"at_step": 250, "move_static": {"name": "wall_0", "position": [..], "states": 60}},
//               {"at_step": 300, "remove_static": "wall_0"}],
//    "programs": [{"client": 1, "said_step": 80, "at_step": 84,
//                  "bodies": [{"body": 3, "quantity": "force", "value": [..]}, {"body": 4, "quantity": "spin"}],
//                  "joints": [{"joint": "j0", "drive": [position, speed, stiffness, damping, effort, max_effort]}],
//                  "statics": [{"static": "lift_0", "position": [..], "states": 2}]}]}
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/order.h"
#include "core/scene.h"
#include "core/setpoint.h"
#include "core/world_cut.h"

namespace aurasim::node {
class Node;
}

namespace aurasim::lab {

class VirtualCluster;

/// Orders that are given together: a new kind of body and the first one of it.
struct Request {
  core::Step at_step = 0;  ///< of the last one; the others hold from when they are known
  std::vector<core::Action> actions;
};

/// What a program says once the run is in state `said_step`.
struct Word {
  core::Step said_step = 0;
  core::Setpoints setpoints;
};

struct Interference {
  core::Step shuffle_ranks_steps = 0;
  std::vector<Request> requests;  ///< ascending at_step
  std::vector<Word> words;        ///< ascending said_step
};

/// The scene that the launch file names, as it is at the start: orders refer to its prototypes by name, and add to
/// them. Without the file there is no interference. Throws std::runtime_error that names the file and what is wrong.
Interference read_interference(const std::filesystem::path& file, const core::Scene& scene);

/// Gives the requests to the lead, each at the last moment, as an impatient client does: so late that it can just take
/// effect in its state. One that comes too late for that takes effect later, and the request says so from then on.
class ImpatientClient {
 public:
  explicit ImpatientClient(std::vector<Request>& requests) : requests_(requests) {}

  /// Before each step of the lead.
  void speak(node::Node& lead);
  /// Instead, once, in a run that goes on from a saved world: all that the world does not know of yet.
  void speak_after(const core::WorldCut& world, node::Node& lead);

 private:
  void ask(node::Node& lead);

  std::vector<Request>& requests_;
  std::size_t next_ = 0;
};

/// Tells every node what programs say, each in the node's own state `said_step`: some compute, some wait, and some
/// are put back by then.
class Programs {
 public:
  /// `from`: the state that the run begins or goes on from; what has acted by then is in the saved world.
  Programs(const std::vector<Word>& words, VirtualCluster& listeners, core::Step from);

  /// Before each step of a node.
  void speak();

 private:
  void speak(node::Node& node, std::size_t& next) const;

  const std::vector<Word>& words_;
  VirtualCluster& listeners_;
  core::Step from_;
  std::vector<std::size_t> next_;  ///< by node
};

}  // namespace aurasim::lab
