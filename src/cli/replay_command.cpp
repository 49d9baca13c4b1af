#include <chrono>
#include <memory>
#include <thread>

#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "host/stop_signal.h"
#include "overseer/mesh_process.h"
#include "overseer/page_messages.h"
#include "overseer/replay.h"
#include "overseer/web_setup.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kReplayRound = 5ms;
constexpr auto kReplayStatusPeriod = 250ms;

struct ReplayArguments {
  std::string file;
  overseer::WebArguments web;
};

std::string replay_message(const overseer::Replay& replay) {
  return nlohmann::json{{"type", "replay"},
                        {"at", replay.at()},
                        {"step", replay.step()},
                        {"playing", replay.playing()},
                        {"speed", replay.speed()}}
      .dump();
}

overseer::Hello hello_of(const overseer::Replay& replay) {
  overseer::Hello hello;
  hello.replay = true;
  hello.scene = replay.run().scene;
  hello.step_s = replay.run().step_s;
  hello.tick_hz = replay.run().tick_hz;
  hello.first = replay.first();
  hello.last = replay.last();
  hello.resets = replay.resets();
  return hello;
}

void serve_requests(overseer::WebServer& web, overseer::Replay& replay) {
  for (const overseer::PageRequest& page_request : web.take_requests()) {
    if (const auto* control = std::get_if<overseer::ReplayControl>(&page_request)) {
      replay.apply(*control);
      web.publish(overseer::Notice::kReplay, replay_message(replay));
    } else {
      const auto& request = std::get<overseer::Request>(page_request);
      web.answer({request.client, request.id, false, "this is a recording", nullptr});
    }
  }
}

int replay(const ReplayArguments& arguments) {
  const overseer::WebSettings settings = overseer::web_settings({}, arguments.web);
  overseer::Replay replay(arguments.file);
  overseer::ShapeStore shapes(overseer::read_mesh_apart);
  const auto web = overseer::open_web_server(settings, arguments.web, shapes);
  web->publish(overseer::Notice::kHello, overseer::hello_message(hello_of(replay)));
  host::catch_stop_signals();
  auto next_status = Clock::now();
  while (!host::stop_requested()) {
    serve_requests(*web, replay);
    overseer::Replay::Output due =
        replay.advance(std::chrono::duration<double>(Clock::now().time_since_epoch()).count());
    for (auto& [notice, text] : due.texts) web->publish(notice, std::move(text));
    for (const overseer::WorldFrame& frame : due.frames) web->show(frame);
    if (Clock::now() >= next_status) {
      next_status = Clock::now() + kReplayStatusPeriod;
      web->publish(overseer::Notice::kReplay, replay_message(replay));
    }
    std::this_thread::sleep_for(kReplayRound);
  }
  command_line::leave(0);
}

}  // namespace

void add_replay(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("replay", "show a recording in the viewer");
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("FILE", arguments->file, "what --record has written")->required()->check(CLI::ExistingFile);
  arguments->web.add_to(*command);
  command->footer("Example:\n  aurasim replay run.rec");
  command->callback([arguments, &action] { action = [arguments] { return replay(*arguments); }; });
}

}  // namespace aurasim::cli
