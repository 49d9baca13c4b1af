// Orders and setpoints that act on a world in mid-run: interference.json beside its launch file.
//   {"orders": [{"at_step": 120, "remove_body": 7},
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
  core::Step at_step = 0;  ///< state of the last action; the others take effect when they are received
  std::vector<core::Action> actions;
};

/// Setpoints that a program sends once the run is in state `said_step`.
struct Word {
  core::Step said_step = 0;
  core::Setpoints setpoints;
};

struct Interference {
  std::vector<Request> requests;  ///< ascending at_step
  std::vector<Word> words;        ///< ascending said_step
};

/// Reads interference.json; without the file there is no interference. `scene`: the launch file's scene at the start,
/// whose prototypes orders name and add to. Throws std::runtime_error that names the file and the error.
Interference read_interference(const std::filesystem::path& file, const core::Scene& scene);

/// Gives each request to the lead at the last moment at which it can still take effect in its state. If it comes too
/// late for that, it takes effect later, and the request's at_step is changed to that state.
class ImpatientClient {
 public:
  explicit ImpatientClient(std::vector<Request>& requests) : requests_(requests) {}

  /// Gives the requests that are due. To be called before each step of the lead.
  void speak(node::Node& lead);
  /// For a run that goes on from a saved world: gives once all requests that the world does not contain. Used instead
  /// of speak().
  void speak_after(const core::WorldCut& world, node::Node& lead);

 private:
  void ask(node::Node& lead);

  std::vector<Request>& requests_;
  std::size_t next_ = 0;
};

/// Sends programs' setpoints to every node when the node itself is in state `said_step`. At that time other nodes may
/// compute, wait, or have gone back.
class Programs {
 public:
  /// `from`: the state that the run begins or goes on from; earlier setpoints are in the saved world.
  Programs(const std::vector<Word>& words, VirtualCluster& listeners, core::Step from);

  /// To be called before each step of a node.
  void speak();

 private:
  void speak(node::Node& node, std::size_t& next) const;

  std::vector<Word> words_;
  VirtualCluster& listeners_;
  core::Step from_;
  std::vector<std::size_t> next_;  ///< by node
};

}  // namespace aurasim::lab
