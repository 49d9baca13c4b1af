#include "agent/agent.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "agent/answers.h"
#include "agent/asked_interest.h"
#include "agent/observation_answer.h"
#include "agent/setpoints.h"
#include "config/shipped_files.h"
#include "cut/cut_file.h"
#include "dds/settings.h"
#include "host/version.h"
#include "setup/key_choice.h"
#include "steering/client_mesh.h"
#include "steering/json_fields.h"

namespace aurasim::agent {
namespace {

using namespace std::chrono_literals;
using client::Message;
using nlohmann::json;
using Steer = messages::RunCommandKind;

constexpr auto kLookEvery = 20ms;

Message failure(Kind kind, const std::string& what) { return {{{"error", name_of(kind)}, {"what", what}}, {}}; }

std::string lines_of(const config::BadConfig& bad) { return fmt::format("{}", fmt::join(bad.errors(), "\n")); }

/// Arguments for `aurasim launch`.
std::vector<std::string> launch_words(const json& asked, const std::string& file) {
  std::vector<std::string> words = {file, "--headless"};
  for (const std::string& change : asked.value("set", std::vector<std::string>{})) {
    words.insert(words.end(), {"--set", change});
  }
  // No states are kept on disk: the client ends the run and can save it, and a crash of the host ends both.
  words.insert(words.begin() + 2, {"--set", "survival.disk=off"});
  for (const char* option : {"as", "load", "report", "saves"}) {
    if (const std::string value = asked.value(option, ""); !value.empty()) {
      words.insert(words.end(), {std::string("--") + option, value});
    }
  }
  words.insert(words.end(), {"--spares", std::to_string(asked.value("spares", 0))});
  words.insert(words.end(), {"--start-time-out",
                             std::to_string(std::clamp(static_cast<int>(asked.value("time_out_s", 60.0)), 1, 3600))});
  return words;
}

}  // namespace

std::vector<steering::Ask> asks_of(const json& asked) {
  const json& list = steering::member(asked, "asks");
  if (!list.is_array()) steering::refuse("asks", steering::shown(list), "a list");
  std::vector<steering::Ask> asks;
  for (const json& ask : list) asks.push_back(steering::read_ask(ask, steering::MeshFiles::kAllowed));
  return asks;
}

void Agent::serve() {
  try {
    while (!closing_) {
      const std::optional<Message> question = client::read_message(socket_, Patience::Clock::now() + kLookEvery);
      if (question) {
        reply(*question);
      } else {
        look();
      }
    }
  } catch (const client::ConnectionLost&) {
    spdlog::info("the client has closed its connection: the agent ends");
  }
  if (run_ && run_->launched() != nullptr) run_->launched()->ask_to_stop();
}

void Agent::look() {
  try {
    if (run_) run_->turn(0ms);
  } catch (const Problem&) {
    // The error is reported with the next request.
  }
}

void Agent::reply(const Message& question) {
  try {
    Message said = answer(question, Patience(socket_, question.head.value("time_out_s", 0.0)));
    said.head["request"] = question.head.value("request", std::uint64_t{0});
    client::write_message(socket_, said);
  } catch (const Abandoned&) {
    // The client does not wait for the answer any more.
  }
}

/// Answers a question. Every exception becomes an answer with the error.
Message Agent::answer(const Message& question, const Patience& patience) {
  try {
    const json& asked = question.head;
    const std::string what = asked.value("do", "");
    if (what == "connect" || what == "launch") return {open(asked, patience), {}};
    if (what == "close") return {close(patience), {}};
    if (what == "control") {
      return {{{"step", run().control(setpoints_of(question, run().launch()), patience)}}, {}};
    }
    return answer_of_run(what, asked, patience);
  } catch (const Problem& problem) {
    return failure(problem.kind(), problem.what());
  } catch (const config::BadConfig& bad) {
    return failure(Kind::kBadFile, lines_of(bad));
  } catch (const Abandoned&) {
    throw;
  } catch (const std::exception& error) {  // JSON that does not fit, DDS, disks
    return failure(Kind::kRefused, error.what());
  }
}

Message Agent::answer_of_run(const std::string& what, const json& asked, const Patience& patience) {
  if (what == "ask") return answer_to_ask(asked, patience);
  if (what == "bodies") return state_message(run().state(patience), run().launch().step_s());
  if (what == "info") return {info_json(run()), {}};
  if (what == "observe") {
    run().wait_for_listeners(patience);
    return {{{"observer", run().observe(asked_interest(asked, run().launch().scene), patience)}}, {}};
  }
  if (what == "next") {
    const Observed observed = run().next(asked.value("observer", std::uint64_t{0}), patience);
    return observation_message(observed, run().launch().step_s());
  }
  if (what == "end_observer") {
    run().end_observer(asked.value("observer", std::uint64_t{0}));
    return {json::object(), {}};
  }
  if (what == "nodes") return {nodes_json(run().nodes(patience)), {}};
  throw Problem(Kind::kRefused, "the agent knows no request '" + what + "'");
}

/// One ask, of any kind; or several commands at once, which are sent together.
Message Agent::answer_to_ask(const json& asked, const Patience& patience) {
  std::vector<steering::Ask> asks = asks_of(asked);
  if (asks.size() == 1) {
    if (const auto* steer = std::get_if<steering::Steer>(&asks.front().what)) return answer_to_steer(*steer, patience);
    if (const auto* drain = std::get_if<steering::Drain>(&asks.front().what)) {
      return {{{"pid", run().drain(drain->region, patience)}}, {}};
    }
  }
  run().wait_for_listeners(patience);
  std::vector<core::Command> commands;
  for (steering::Ask& ask : asks) {
    if (!std::holds_alternative<core::Ask>(ask.what)) {
      throw Problem(Kind::kRefused, "pause, resume, step, reset, stop and drain: ask for one of them at a time");
    }
    commands.push_back(steering::command_of(std::move(ask), run().launch().scene, run().client()));
  }
  const core::Ask first = commands.empty() ? core::Ask() : commands.front().ask;
  const std::vector<steering::Delivery> deliveries = run().act(std::move(commands), patience);
  const auto* const save = std::get_if<core::Save>(&first);
  if (deliveries.size() == 1 && save != nullptr) return {save_json(deliveries.front(), save->file), {}};
  if (deliveries.size() == 1 && deliveries.front().is_ray) return {ray_json(deliveries.front()), {}};
  json acts = json::array();
  for (const steering::Delivery& delivery : deliveries) acts.push_back(act_json(delivery));
  return {{{"acts", std::move(acts)}}, {}};
}

Message Agent::answer_to_steer(const steering::Steer& steer, const Patience& patience) {
  const auto state = [this](const WorldState& world) { return state_message(world, run().launch().step_s()); };
  if (steer.kind == Steer::kPause) return state(run().pause(patience));
  if (steer.kind == Steer::kStep) return state(run().step(steer.count, patience));
  run().steer(steer.kind, patience);
  return {json::object(), {}};
}

RunLink& Agent::run() {
  if (!run_) throw Problem(Kind::kEnded, "this world is not connected");
  run_->turn(0ms);
  return *run_;
}

json Agent::open(const json& asked, const Patience& patience) {
  if (asked.value("protocol", 0) != client::kAgentProtocol) {
    throw Problem(Kind::kNoProgram,
                  fmt::format("{} speaks version {} of the agent's protocol, the library {}",
                              host::version_and_commit(), client::kAgentProtocol, asked.value("protocol", 0)));
  }
  if (run_) throw Problem(Kind::kRefused, "this world is connected already");
  const std::string file = config::launch_file_named(asked.value("file", ""));
  const config::Launch launch = config::read_launch(file, asked.value("set", std::vector<std::string>{}));
  const auto member = setup::member_for(launch, asked.value("as", ""), {security::Role::kOperator});
  auto run = std::make_unique<RunLink>(launch, member);
  const bool launches = asked.value("do", "") == "launch";
  if (launches) run->own(std::make_unique<LaunchedRun>(launch_words(asked, file)));
  // The link stays if meeting the run fails: a participant that is deleted may end other processes
  // (command_line/leave.h).
  run_ = std::move(run);
  try {
    run_->meet(patience);
    if (launches && asked.value("paused", false)) begin_paused(patience);
  } catch (...) {
    if (launches) run_->launched()->ask_to_stop();
    throw;
  }
  return {{"version", host::version_and_commit()}, {"launcher", launches ? run_->launched()->pid() : 0}};
}

/// Begins a launched run paused. No node can be paused before it has begun, so the run is paused and reset, and stays
/// in its first state.
void Agent::begin_paused(const Patience& patience) {
  run_->pause(patience);
  run_->steer(Steer::kReset, patience);
}

json Agent::close(const Patience& patience) {
  closing_ = true;
  const bool launched = run_ && run_->launched() != nullptr;
  return {{"exit_code", launched ? run_->launched()->stop(patience.deadline()) : 0}};
}

}  // namespace aurasim::agent
