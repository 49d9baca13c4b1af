// Sends the requests of web pages to the run: those that steer the whole run as run commands, all others as commands of
// clients (steering/command_client.h). Never blocks. A request is answered when its effect has been seen.
#pragma once

#include <chrono>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "overseer/commands.h"
#include "overseer/part_finder.h"
#include "overseer/shape_store.h"
#include "steering/command_client.h"
#include "steering/drain.h"
#include "steering/run_steering.h"

namespace aurasim::overseer {

class RunCommandSink final : public CommandSink {
 public:
  /// All arguments must outlive this object.
  RunCommandSink(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control,
                 const ShapeStore& shapes)
      : launch_(launch),
        control_(control),
        steering_(launch, control),
        client_(participant, control, launch.agreement()),
        shapes_(shapes) {}

  void submit(Request request) override;
  std::vector<Reply> take_replies() override;

 private:
  struct UnderWay {
    ClientId client{};
    std::string request;
    messages::RunCommand command;
    std::chrono::steady_clock::time_point deadline;
  };
  struct Leaving {
    ClientId client{};
    std::string request;
    steering::Draining drain;
    core::RegionId region{};
    std::chrono::steady_clock::time_point deadline;
  };
  void steer(const Request& request, const steering::Steer& steer);
  void drain(const Request& request, core::RegionId region);
  void refuse(const Request& request, std::string why);
  void reply_to_drains();

  struct Sent {
    ClientId client{};
    std::string request;
  };
  struct Held {
    Request request;
    std::chrono::steady_clock::time_point deadline;
  };
  void carry_held();
  bool waits_for_parts(const Request& request);
  core::MeshRef parts_of(std::uint64_t hash, const std::shared_ptr<const core::TriangleMesh>& mesh);
  void carry(const Request& request);
  void bring_mesh_of(core::Ask& ask);

  const config::Launch& launch_;
  dds::ControlBus& control_;
  steering::RunSteering steering_;
  steering::CommandClient client_;
  const ShapeStore& shapes_;
  PartFinder part_finder_;
  /// Requests held until all nodes have discovered this process, which takes a moment at its start, or until a mesh has
  /// been taken apart.
  std::vector<Held> held_;
  std::map<std::uint64_t, Sent> sent_;
  std::vector<UnderWay> under_way_;
  std::list<Leaving> leaving_;
  std::vector<Reply> replies_;
};

}  // namespace aurasim::overseer
