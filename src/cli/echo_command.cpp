#include <algorithm>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fnmatch.h>

#include "cli/commands.h"
#include "command_line/leave.h"
#include "dds/control.h"
#include "dds/topic_echo.h"
#include "host/stop_signal.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"
#include "topics/topics.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct EchoArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  std::string topic;
  std::string partition;  ///< empty: all of them
  std::uint64_t count = 0;
  double duration_s = 0;
  bool json = false;

  topics::TopicId id() const { return topics::topic_named(topic).value(); }
};

std::vector<std::string> topic_names() {
  std::vector<std::string> names;
  for (const topics::Topic& topic : topics::all()) names.emplace_back(topic.name);
  return names;
}

void print_sample(const nlohmann::ordered_json& sample, bool json) {
  if (json) {
    fmt::print("{}\n", sample.dump());
  } else {
    for (const auto& [name, value] : sample.items()) fmt::print("{}: {}\n", name, value.dump());
    fmt::print("---\n");
  }
  std::fflush(stdout);
}

/// Checks the partition, because DDS accepts a pattern that matches nothing and then delivers nothing.
void check_partition(const EchoArguments& arguments, const config::Launch& launch) {
  const std::vector<std::string> partitions = topics::partitions_in_run(arguments.id(), launch.regions.size());
  const auto fits = [&](const std::string& name) {
    return ::fnmatch(arguments.partition.c_str(), name.c_str(), 0) == 0;
  };
  if (std::any_of(partitions.begin(), partitions.end(), fits)) return;
  throw config::BadConfig(
      {fmt::format("--partition: found '{}', allowed for {}: {}{}, or a pattern with *", arguments.partition,
                   arguments.topic, partitions.front(), partitions.size() > 1 ? " to " + partitions.back() : "")});
}

/// Checks that the key permits the topic. DDS alone would only say that the reader cannot be created.
void check_permission(const std::string& topic, const std::string& partition,
                      const std::optional<security::Member>& member) {
  if (!member) return;
  const security::Grants grants = security::grants_of(member->role, member->region);
  if (security::is_granted(grants.subscribes, topic, partition)) return;
  throw config::BadConfig({fmt::format("{} of role {} may not read {} in partition {}; a recorder may (--as)",
                                       member->name, name_of(member->role), topic, partition)});
}

/// Prints the samples. Returns 0 when the requested number has come, or when no number was requested.
int echo(const EchoArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  if (!arguments.partition.empty()) check_partition(arguments, launch);
  const std::string partition =
      arguments.partition.empty() ? topics::every_partition_of(arguments.id()) : arguments.partition;
  using security::Role;
  const auto member = setup::member_for(launch, arguments.keys.as,
                                        {Role::kRecorder, Role::kViewer, Role::kOperator, Role::kSpare, Role::kRegion});
  check_permission(arguments.topic, partition, member);
  dds::Participant participant(setup::with_keys(setup::dds_settings(launch), launch, member));
  dds::TopicEcho topic(participant, arguments.id(), partition);
  dds::ControlBus control(participant, {.only_watches = true});
  host::catch_stop_signals();
  const auto begin = Clock::now();
  const auto end = begin + std::chrono::duration<double>(arguments.duration_s);
  std::uint64_t left = arguments.count;
  bool has_received = false;
  const auto nobody = [&] { return !has_received && control.statuses().empty() && !host::stop_requested(); };
  while (!host::stop_requested() && (arguments.duration_s <= 0 || Clock::now() < end)) {
    if (const auto sample = topic.take()) {
      has_received = true;
      print_sample(*sample, arguments.json);
      if (arguments.count > 0 && --left == 0) break;
    } else {
      topic.wait(50ms);
      control.wait(0ms);
      if (nobody() && Clock::now() - begin > setup::kPatienceWithSilence) break;
    }
  }
  if (nobody()) setup::fail_for_want_of_a_run(arguments.files, launch, participant);
  command_line::leave(left == 0 ? 0 : 1);
}

}  // namespace

void add_echo(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("echo", "print what is said on a topic of a run");
  const auto arguments = std::make_shared<EchoArguments>();
  command->add_option("TOPIC", arguments->topic, "its name")->required()->check(CLI::IsMember(topic_names()));
  arguments->files.add_to(*command);
  arguments->keys.add_to(*command);
  command->add_option("--partition", arguments->partition, "such as region/3, region/*, world; default: all");
  command->add_option("--count", arguments->count, "stop after so many samples");
  command->add_option("--duration", arguments->duration_s, "stop after so many seconds; 0: on Ctrl-C");
  command->add_flag("--json", arguments->json, "one object per line");
  command->footer("Example:\n  aurasim echo aura demo --partition region/2 --count 5");
  command->callback([arguments, &action] { action = [arguments] { return echo(*arguments); }; });
}

}  // namespace aurasim::cli
