// What pages can ask of a run that is steered by run commands: pause, resume, step, reset. Never waits; a request is
// answered when every node shows its effect.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "cli/run_steering.h"
#include "overseer/commands.h"

namespace aurasim::cli {

class RunCommandSink final : public overseer::CommandSink {
 public:
  /// Both outlive it.
  RunCommandSink(const config::Launch& launch, dds::ControlBus& control) : steering_(launch, control) {}

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

  RunSteering steering_;
  std::vector<UnderWay> under_way_;
  std::vector<overseer::Reply> replies_;
};

}  // namespace aurasim::cli
