#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/launch_setup.h"
#include "cli/leave.h"
#include "cli/stop_signal.h"
#include "dds/topic_echo.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Arguments {
  FileArguments files;
  std::string topic;
  std::string partition = "*";
  std::uint64_t count = 0;
  double duration_s = 0;
  bool json = false;
};

void print(const nlohmann::ordered_json& sample, bool json) {
  if (json) {
    fmt::print("{}\n", sample.dump());
  } else {
    for (const auto& [name, value] : sample.items()) fmt::print("{}: {}\n", name, value.dump());
    fmt::print("---\n");
  }
  std::fflush(stdout);
}

/// 0 when as many as asked for have come, or when no number was asked for.
int echo(const Arguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  dds::Participant participant(dds_settings(launch));
  dds::TopicEcho topic(participant, arguments.topic, arguments.partition);
  catch_stop_signals();
  const auto end = Clock::now() + std::chrono::duration<double>(arguments.duration_s);
  std::uint64_t left = arguments.count;
  while (!stop_requested() && (arguments.duration_s <= 0 || Clock::now() < end)) {
    if (const auto sample = topic.take()) {
      print(*sample, arguments.json);
      if (arguments.count > 0 && --left == 0) break;
    } else {
      topic.wait(50ms);
    }
  }
  leave(left == 0 ? 0 : 1);
}

}  // namespace

void add_echo(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("echo", "print what is said on a topic of a run");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("TOPIC", arguments->topic, "its name")->required()->check(CLI::IsMember(dds::topic_names()));
  arguments->files.add_to(*command);
  command->add_option("--partition", arguments->partition, "such as region/3, region/*, world; default: all");
  command->add_option("--count", arguments->count, "stop after so many samples");
  command->add_option("--duration", arguments->duration_s, "stop after so many seconds; 0: on Ctrl-C");
  command->add_flag("--json", arguments->json, "one object per line");
  command->callback([arguments, &action] { action = [arguments] { return echo(*arguments); }; });
}

}  // namespace aurasim::cli
