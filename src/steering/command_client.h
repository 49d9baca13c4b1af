// Sends commands to a run and collects their outcomes: one for each command, however many replies come. Never blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/command.h"
#include "dds/command_bus.h"
#include "dds/control.h"

namespace aurasim::steering {

struct Delivery {
  std::uint64_t request = 0;
  bool done = false;
  bool timed_out = false;  ///< not done, and no reply says why
  std::string text;        ///< reason of a refusal, or what was done
  core::Step at_step = 0;
  std::optional<core::ObjectRef> object;  ///< the new body or static, or the object that a ray hit
  // Only for a ray:
  bool is_ray = false;
  core::Vec3 p_W = core::Vec3::Zero();
  core::Vec3 normal_W = core::Vec3::Zero();
  double distance_m = 0;
  std::vector<core::RegionId> silent;  ///< regions that did not answer, so that a nearer hit is possible
  // Only for a saved world:
  bool is_save = false;
  std::vector<std::string> files;  ///< files of the parts, on their nodes' hosts
};

class CommandClient {
 public:
  /// `participant` and `control` must outlive the client. `agreement`: the agreement of the run to be commanded.
  CommandClient(dds::Participant& participant, dds::ControlBus& control, std::uint64_t agreement);

  /// True if this client's endpoints are matched with those of all live nodes, in both directions.
  bool all_listen();
  /// Sends a command and returns its request id. The command is repeated until its outcome is known, because a reply is
  /// lost if its writer had not yet discovered this client. Nodes execute each request once.
  std::uint64_t send(core::Command command);
  /// Publishes a mesh to the nodes, unless all have it.
  void bring(std::uint64_t hash, const core::TriangleMesh& mesh);
  /// Outcomes of the commands that have ended since the last call.
  std::vector<Delivery> take();
  void wait(std::chrono::nanoseconds time_out) { endpoint_.wait(time_out); }

 private:
  using Clock = std::chrono::steady_clock;
  struct UnderWay {
    Delivery delivery;
    bool accepted = false;
    bool changes_the_run = false;
    bool stands = false;       ///< a world is saved in the state in which the run is paused
    bool has_gone_on = false;  ///< some node has left that state since
    bool has_time = false;     ///< the command named its state: the client does not wait for it
    std::optional<core::BodyId> subject;
    std::vector<core::RegionId> asked;  ///< regions that a ray asks; none: all
    std::vector<core::RegionId> answered;
    core::Command command;
    Clock::time_point again;  ///< when the command is sent again
    Clock::time_point deadline;
  };

  std::vector<const messages::Status*> live_nodes();
  std::optional<core::Step> paused_in();
  void accept(const core::CommandReply& reply, UnderWay& under_way);
  void note(const core::CommandReply& reply, UnderWay& under_way);
  bool has_ended(UnderWay& under_way);
  bool all_have_answered(UnderWay& under_way);
  bool ray_has_ended(UnderWay& under_way);
  bool is_on_its_way(const UnderWay& under_way);
  bool has_gone_on_from(core::Step step);

  dds::ControlBus& control_;
  std::uint64_t agreement_;
  dds::CommandClientEndpoint endpoint_;
  std::map<std::uint64_t, UnderWay> under_way_;
};

}  // namespace aurasim::steering
