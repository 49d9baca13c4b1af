#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "cli/ask_options.h"
#include "cli/commands.h"
#include "command_line/exit_code.h"
#include "command_line/leave.h"
#include "core/limits.h"
#include "cut/saved_parts.h"
#include "cut/saved_world.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"
#include "steering/client_mesh.h"
#include "steering/command_client.h"
#include "steering/drain.h"
#include "steering/run_steering.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Kind = messages::RunCommandKind;

constexpr auto kPatienceWithAPause = 10s;
constexpr auto kPatienceWithTheRun = 60s;  ///< in slow motion an order's state may take that long

struct SendArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  steering::Ask ask;
};

[[noreturn]] void fail(const std::string& why) {
  spdlog::error("{}", why);
  command_line::leave(static_cast<int>(command_line::ExitCode::kFailed));
}

nlohmann::json json_list(const core::Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Joins the parts into one file, if all of them are on this host.
nlohmann::json whole_or_parts(const std::vector<std::string>& parts, const std::string& name) {
  const cut::PutTogether made = cut::put_together(parts, name);
  if (!made.file.empty()) return {{"file", made.file}, {"bytes", made.bytes}};
  spdlog::warn("the parts are on their nodes' hosts: `aurasim cut merge {} PART...` puts them together", name);
  return {{"parts", parts}};
}

/// `save_name`: of the world, if it is a save.
[[noreturn]] void print_delivery(const steering::Delivery& delivery, const std::string& save_name) {
  if (!delivery.done) fail(delivery.text);
  nlohmann::json out = {{"step", delivery.at_step}};
  if (delivery.is_save && !delivery.files.empty()) out.update(whole_or_parts(delivery.files, save_name));
  if (delivery.object)
    out[*delivery.object >= 0 ? "body" : "static"] = *delivery.object >= 0 ? *delivery.object : -1 - *delivery.object;
  if (delivery.is_ray) {
    out["hit"] = delivery.object.has_value();
    out["complete"] = delivery.silent.empty();
    if (delivery.object) {
      out["p"] = json_list(delivery.p_W);
      out["normal"] = json_list(delivery.normal_W);
      out["distance_m"] = delivery.distance_m;
    }
  }
  fmt::print("{}\n", out.dump());
  command_line::leave(0);
}

[[noreturn]] void carry(const SendArguments& arguments, dds::Participant& participant, dds::ControlBus& control,
                        const config::Launch& launch) {
  steering::CommandClient client(participant, control, launch.agreement());
  const auto deadline = std::chrono::steady_clock::now() + kPatienceWithTheRun;
  const auto in_time = [&] { return std::chrono::steady_clock::now() < deadline; };
  while (!client.all_listen() && in_time()) client.wait(20ms);
  core::Command command;
  try {
    command = steering::command_of(arguments.ask, launch.scene, client);
  } catch (const steering::BadAsk& bad) {
    fail(bad.what());
  }
  const auto* const save = std::get_if<core::Save>(&command.ask);
  const std::string save_name = save != nullptr ? save->file : "";
  client.send(std::move(command));
  while (in_time()) {
    client.wait(20ms);
    for (const steering::Delivery& delivery : client.take()) print_delivery(delivery, save_name);
  }
  fail("no answer");
}

[[noreturn]] void steer(const steering::Steer& asked, steering::RunSteering& steering) {
  // A world that has gone back in a pause first computes up to the paused state again.
  if (asked.kind == Kind::kStep && !steering.wait_until_paused(kPatienceWithAPause))
    fail("steps are for a run that is paused");
  const messages::RunCommand command = steering.send(asked.kind, asked.count);
  if (!steering.wait_for_effect(command, kPatienceWithTheRun)) {
    fail(fmt::format("{} was sent, but not every node shows its effect", messages::name_of(asked.kind)));
  }
  fmt::print("{}: done at step {}\n", messages::name_of(asked.kind), command.at_step);
  command_line::leave(0);
}

/// Drains a region. Done when another process computes the region and the run goes on.
[[noreturn]] void drain(core::RegionId region, dds::ControlBus& control) {
  steering::Draining leaving(control, region);
  const auto deadline = std::chrono::steady_clock::now() + kPatienceWithTheRun;
  while (std::chrono::steady_clock::now() < deadline) {
    control.wait(20ms);
    const messages::Status* const successor = leaving.successor();
    if (successor == nullptr) continue;
    fmt::print("drain: process {} has taken region {} over by step {}\n", successor->pid, core::value_of(region),
               successor->step);
    command_line::leave(0);
  }
  fail(steering::kNobodyTakesOver);
}

int send(const SendArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  const auto member = setup::member_for(launch, arguments.keys.as, {security::Role::kOperator});
  dds::Participant participant(setup::with_keys(setup::dds_settings(launch), launch, member));
  dds::ControlBus control(participant, {.agreement = launch.agreement(),
                                        .region_count = static_cast<std::uint32_t>(launch.regions.size())});
  steering::RunSteering steering(launch, control);
  if (!steering.find_run(5s)) {
    const bool differs = !control.strangers().empty();
    fail(fmt::format("no run of {} in DDS domain {}{}{}", arguments.files.file, launch.dds.domain,
                     differs ? ", but one that differs: give the same file and --set as its nodes have" : "",
                     setup::word_about_keys(participant.peers_by_keys(), launch)));
  }
  command_line::leave_after([&]() -> command_line::ExitCode {
    if (const auto* asked = std::get_if<steering::Drain>(&arguments.ask.what)) drain(asked->region, control);
    if (const auto* asked = std::get_if<steering::Steer>(&arguments.ask.what)) steer(*asked, steering);
    carry(arguments, participant, control, launch);
  });
}

std::string example_of(const steering::AskKind& kind) {
  return fmt::format("Example:\n  aurasim send {} demo{}{}", kind.name, kind.example.empty() ? "" : " ", kind.example);
}

}  // namespace

void add_send(CLI::App& program, command_line::Action& action) {
  CLI::App* send_app = program.add_subcommand("send", "tell a run what to do");
  send_app->require_subcommand(1);
  send_app->footer("Example:\n  aurasim send spawn demo --radius 0.5 --p 0 0 10 --v 5 0 0");
  const auto arguments = std::make_shared<SendArguments>();
  for (const steering::AskKind& kind : steering::asks()) {
    CLI::App* command = send_app->add_subcommand(std::string(kind.name), std::string(kind.help));
    arguments->files.add_to(*command);
    arguments->keys.add_to(*command);
    const auto options = std::make_shared<AskOptions>(kind);
    options->add_to(*command);
    command->footer(example_of(kind));
    command->callback([arguments, options, &kind, &action] {
      try {
        arguments->ask = steering::read_ask(options->ask(), steering::MeshFiles::kAllowed);
      } catch (const steering::BadAsk& bad) {
        throw config::BadConfig({bad.what(), fmt::format("the options: aurasim send {} --help", kind.name)});
      }
      action = [arguments] { return send(*arguments); };
    });
  }
}

}  // namespace aurasim::cli
