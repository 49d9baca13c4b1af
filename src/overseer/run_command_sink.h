// Sends the requests of web pages to the run: pause, resume, step and reset as run commands, all others as commands of
// clients (steering/command_client.h). Never blocks. A request is answered when its effect has been seen.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "overseer/commands.h"
#include "overseer/part_finder.h"
#include "overseer/shape_store.h"
#include "steering/command_client.h"
#include "steering/run_steering.h"

namespace aurasim::overseer {

class RunCommandSink final : public overseer::CommandSink {
 public:
  /// All arguments must outlive this object.
  RunCommandSink(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control,
                 const overseer::ShapeStore& shapes)
      : steering_(launch, control), client_(participant, control, launch.agreement()), shapes_(shapes) {}

  void submit(overseer::Request request) override;
  std::vector<overseer::Reply> take_replies() override;

 private:
  struct UnderWay {
    overseer::ClientId client{};
    std::string request;
    dds::RunCommand command;
    std::chrono::steady_clock::time_point deadline;
  };
  void steer(const overseer::Request& request, dds::RunCommandKind kind, std::int64_t count);

  struct Sent {
    overseer::ClientId client{};
    std::string request;
  };
  struct Held {
    overseer::Request request;
    std::chrono::steady_clock::time_point deadline;
  };
  void carry_held();
  bool waits_for_parts(const overseer::Request& request);
  core::MeshRef parts_of(std::uint64_t hash, const std::shared_ptr<const core::TriangleMesh>& mesh);
  void carry(const overseer::Request& request);
  core::ClientShape client_shape(const overseer::ShapeChoice& choice);
  core::Ask ask_for(const overseer::Command& command);

  steering::RunSteering steering_;
  steering::CommandClient client_;
  const overseer::ShapeStore& shapes_;
  PartFinder part_finder_;
  /// Requests held until all nodes have discovered this process, which takes a moment at its start, or until a mesh has
  /// been taken apart.
  std::vector<Held> held_;
  std::map<std::uint64_t, Sent> sent_;
  std::vector<UnderWay> under_way_;
  std::vector<overseer::Reply> replies_;
};

}  // namespace aurasim::overseer
