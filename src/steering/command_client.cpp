#include "steering/command_client.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::steering {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatienceForAnswers = 15s;
constexpr auto kPatienceForMeshes = 20s;  ///< longer than the 15 s for which the lead waits
constexpr auto kPatienceAfterIt = 2s;     ///< for the host's reply, once all have computed the state
constexpr auto kPatienceForChanges = 20s;
constexpr auto kPatienceForDisks = 20s;  ///< time to write a saved world
constexpr auto kAgain = 500ms;
constexpr std::uint64_t kAnyMap = 0;   ///< accept any map: a domain has one run, whose map may be changing just now
constexpr auto kPatienceForRays = 2s;  ///< patience with a region that is busy

}  // namespace

CommandClient::CommandClient(dds::Participant& participant, dds::ControlBus& control, std::uint64_t agreement)
    : control_(control), agreement_(agreement), endpoint_(participant) {}

std::vector<const messages::Status*> CommandClient::live_nodes() {
  std::vector<const messages::Status*> live;
  for (const auto& [region, seen] : control_.statuses()) {
    if (seen.is_live() && seen.status.agreement == agreement_) live.push_back(&seen.status);
  }
  return live;
}

bool CommandClient::all_listen() {
  const std::size_t live = live_nodes().size();
  return live > 0 && endpoint_.listeners() >= live;
}

void CommandClient::bring(std::uint64_t hash, const core::TriangleMesh& mesh) {
  const auto live = live_nodes();
  const bool all_have = std::ranges::all_of(live, [hash](const messages::Status* node) {
    return std::ranges::find(node->meshes, hash) != node->meshes.end();
  });
  if (!all_have || live.empty()) endpoint_.bring(hash, mesh);
}

std::uint64_t CommandClient::send(core::Command command) {
  UnderWay under_way;
  under_way.subject = core::body_of(command.ask);
  under_way.has_time = command.at_step > 0;
  under_way.changes_the_run = core::changes_the_run(command.ask);
  const auto* const ray = std::get_if<core::Ray>(&command.ask);
  under_way.delivery.is_ray = ray != nullptr;
  under_way.delivery.is_save = std::holds_alternative<core::Save>(command.ask);
  if (ray != nullptr) under_way.asked = ray->regions;
  under_way.delivery.distance_m = std::numeric_limits<double>::infinity();
  const Clock::duration patience = under_way.delivery.is_ray               ? Clock::duration(kPatienceForRays)
                                   : core::mesh_in(command.ask) != nullptr ? Clock::duration(kPatienceForMeshes)
                                                                           : Clock::duration(kPatienceForAnswers);
  under_way.deadline = Clock::now() + patience;
  const std::uint64_t request = endpoint_.send(command, kAnyMap);
  under_way.command = std::move(command);
  under_way.command.request = request;
  under_way.again = Clock::now() + kAgain;
  under_way.delivery.request = request;
  under_way_.emplace(request, std::move(under_way));
  return request;
}

void CommandClient::accept(const core::CommandReply& reply, UnderWay& under_way) {
  if (under_way.accepted) return;  // a repeated reply
  Delivery& delivery = under_way.delivery;
  under_way.accepted = true;
  under_way.deadline = Clock::now() + (under_way.changes_the_run ? Clock::duration(kPatienceForChanges)
                                       : delivery.is_save        ? Clock::duration(kPatienceForDisks)
                                                                 : Clock::duration(kPatienceAfterIt));
  delivery.at_step = reply.at_step;
  delivery.object = reply.object;
  if (!delivery.is_save) return;
  under_way.stands = reply.text == core::kSavedAsItStands || paused_in() >= reply.at_step;
  if (under_way.stands) {  // this client passes the state on to the other nodes
    under_way.command.at_step = reply.at_step;
    under_way.again = Clock::now();
  }
}

void CommandClient::note(const core::CommandReply& reply, UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  switch (reply.outcome) {
    case core::Outcome::kAccepted:
      accept(reply, under_way);
      return;
    case core::Outcome::kDone:
      delivery.done = true;
      delivery.at_step = reply.at_step;
      if (reply.object) delivery.object = reply.object;  // the host's reply may come before the lead's
      delivery.text = fmt::format("done at step {}", reply.at_step);
      under_way.deadline = {};
      return;
    case core::Outcome::kRefused:
      delivery.done = false;
      delivery.text = reply.text.empty() ? "refused" : reply.text;
      under_way.deadline = {};
      return;
    case core::Outcome::kSeen:
      if (delivery.is_save) accept(reply, under_way);  // a saved part implies acceptance, whose reply may be lost
      if (std::ranges::find(under_way.answered, reply.source) != under_way.answered.end()) return;  // a repeated reply
      under_way.answered.push_back(reply.source);
      delivery.at_step = std::max(delivery.at_step, reply.at_step);
      if (delivery.is_save) delivery.files.push_back(reply.text);
      if (!reply.object || reply.distance_m >= delivery.distance_m) return;
      delivery.object = reply.object;
      delivery.p_W = reply.p_W;
      delivery.normal_W = reply.normal_W;
      delivery.distance_m = reply.distance_m;
      return;
  }
}

/// The state in which all live nodes are paused. Nothing if they are not.
std::optional<core::Step> CommandClient::paused_in() {
  std::optional<core::Step> step;
  for (const messages::Status* node : live_nodes()) {
    if (node->state != messages::NodeState::kPaused) return std::nullopt;
    step = std::max(step.value_or(node->step), node->step);
  }
  return step;
}

bool CommandClient::all_have_answered(UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  delivery.silent.clear();
  const auto is_in = [](const auto& regions, core::RegionId region) {
    return std::ranges::find(regions, region) != regions.end();
  };
  for (const messages::Status* node : live_nodes()) {
    const bool asked = under_way.asked.empty() || is_in(under_way.asked, node->region);
    if (asked && !is_in(under_way.answered, node->region)) delivery.silent.push_back(node->region);
  }
  return delivery.silent.empty() && !under_way.answered.empty();
}

bool CommandClient::ray_has_ended(UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  if (!delivery.text.empty()) return true;  // refused
  const bool late = Clock::now() >= under_way.deadline;
  if (!all_have_answered(under_way) && !late) return false;
  delivery.done = !under_way.answered.empty();
  delivery.timed_out = !delivery.done;
  delivery.text = delivery.done ? "" : "no region has answered";
  return true;
}

/// True if the command is accepted and its state is still to come, which may take many seconds in slow motion.
bool CommandClient::is_on_its_way(const UnderWay& under_way) {
  return under_way.accepted && !under_way.changes_the_run && under_way.delivery.text.empty() &&
         std::ranges::any_of(live_nodes(), [&](const messages::Status* node) {
           return node->state == messages::NodeState::kRunning && node->step < under_way.delivery.at_step;
         });
}

bool CommandClient::has_gone_on_from(core::Step step) {
  return std::ranges::any_of(live_nodes(), [step](const messages::Status* node) { return node->step > step; });
}

bool CommandClient::has_ended(UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  if (delivery.is_ray) return ray_has_ended(under_way);
  if (delivery.is_save && delivery.text.empty() && all_have_answered(under_way)) {
    delivery.done = true;
    delivery.text = fmt::format("saved state {}", delivery.at_step);
    return true;
  }
  if (under_way.accepted && under_way.has_time && !delivery.done) {
    delivery.done = true;
    delivery.text = fmt::format("takes effect in step {}", delivery.at_step);
    return true;
  }
  if (under_way.stands && !under_way.has_gone_on && has_gone_on_from(delivery.at_step)) {
    under_way.has_gone_on = true;  // nodes that have not saved their part by now never will
    under_way.deadline = std::min(under_way.deadline, Clock::now() + kPatienceAfterIt);
  }
  if (is_on_its_way(under_way)) under_way.deadline = std::max(under_way.deadline, Clock::now() + kPatienceAfterIt);
  if (Clock::now() < under_way.deadline) {
    const std::optional<core::Step> paused = paused_in();
    if (!under_way.accepted || under_way.changes_the_run || !paused) return false;  // changes pause nodes, too
    if (delivery.is_save && (under_way.stands || *paused >= delivery.at_step)) return false;  // being written
    delivery.done = !delivery.is_save;
    delivery.text = fmt::format("the run is paused; takes effect in step {}", delivery.at_step);
    return true;
  }
  if (!delivery.text.empty()) return true;
  delivery.timed_out = !under_way.has_gone_on && (!under_way.accepted || !under_way.subject);
  delivery.text =
      !under_way.accepted ? fmt::format("no node has accepted the command: {} nodes are alive, and {} receive commands",
                                        live_nodes().size(), endpoint_.listeners())
      : under_way.has_gone_on
          ? fmt::format("the run has gone on from state {} before all regions had saved it: ask for the save again",
                        delivery.at_step)
      : delivery.is_save  ? "some regions have not saved their parts"
      : under_way.subject ? fmt::format("there is no body {}", core::value_of(*under_way.subject))
                          : "the command was accepted, but no node has reported its effect";
  return true;
}

std::vector<Delivery> CommandClient::take() {
  for (const core::CommandReply& reply : endpoint_.take()) {
    const auto found = under_way_.find(reply.request);
    if (found != under_way_.end()) note(reply, found->second);
  }
  std::vector<Delivery> ended;
  for (auto entry = under_way_.begin(); entry != under_way_.end();) {
    UnderWay& under_way = entry->second;
    if (!has_ended(under_way)) {
      if (Clock::now() >= under_way.again) {
        endpoint_.send(under_way.command, kAnyMap);
        under_way.again = Clock::now() + kAgain;
      }
      ++entry;
      continue;
    }
    ended.push_back(std::move(under_way.delivery));
    entry = under_way_.erase(entry);
  }
  return ended;
}

}  // namespace aurasim::steering
