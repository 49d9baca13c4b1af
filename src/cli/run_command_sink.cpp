#include "cli/run_command_sink.h"

#include <utility>

#include <fmt/format.h>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Kind = dds::RunCommandKind;

constexpr auto kPatience = 10s;

}  // namespace

void RunCommandSink::submit(overseer::Request request) {
  if (std::holds_alternative<overseer::Pause>(request.command)) {
    steer(request, Kind::kPause, 1);
  } else if (std::holds_alternative<overseer::Resume>(request.command)) {
    steer(request, Kind::kResume, 1);
  } else if (std::holds_alternative<overseer::Reset>(request.command)) {
    steer(request, Kind::kReset, 1);
  } else if (const auto* step = std::get_if<overseer::StepOn>(&request.command)) {
    steer(request, Kind::kStep, step->count);
  } else {
    replies_.push_back(overseer::not_supported(request));
  }
}

void RunCommandSink::steer(const overseer::Request& request, Kind kind, std::int64_t count) {
  const auto refuse = [&](std::string why) {
    replies_.push_back({request.client, request.id, false, std::move(why), nullptr});
  };
  if (!steering_.is_there()) return refuse("no node of this run is there");
  if (kind == Kind::kStep && !steering_.is_paused()) return refuse("steps are for a run that is paused");
  try {
    under_way_.push_back({request.client, request.id, steering_.send(kind, count), Clock::now() + kPatience});
  } catch (const dds::DdsError& error) {
    refuse(error.what());
  }
}

std::vector<overseer::Reply> RunCommandSink::take_replies() {
  std::erase_if(under_way_, [this](const UnderWay& waiting) {
    const bool done = steering_.has_taken_effect(waiting.command);
    if (!done && Clock::now() < waiting.deadline) return false;
    const char* kind = dds::name_of(waiting.command.kind);
    std::string text = done ? fmt::format("{}: done at step {}", kind, waiting.command.at_step)
                            : fmt::format("{} was sent, but not every node shows its effect", kind);
    replies_.push_back({waiting.client, waiting.request, done, std::move(text), nullptr});
    return true;
  });
  return std::exchange(replies_, {});
}

}  // namespace aurasim::cli
