#include "cli/command_client.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatienceForAnswers = 6s;
constexpr auto kPatienceAfterIt = 2s;  ///< a host says so when it is done
constexpr auto kPatienceForChanges = 20s;
constexpr auto kPatienceForRays = 2s;  ///< of a region that is busy; who has answered is not waited for

}  // namespace

CommandClient::CommandClient(dds::Participant& participant, dds::ControlBus& control, std::uint64_t agreement)
    : control_(control), agreement_(agreement), endpoint_(participant) {}

std::vector<const dds::Status*> CommandClient::live_nodes() {
  std::vector<const dds::Status*> live;
  for (const auto& [region, seen] : control_.statuses()) {
    if (seen.is_live() && seen.status.agreement == agreement_) live.push_back(&seen.status);
  }
  return live;
}

bool CommandClient::all_listen() {
  const std::size_t live = live_nodes().size();
  return live > 0 && endpoint_.listeners() >= live;
}

std::uint64_t CommandClient::send(core::Command command) {
  UnderWay under_way;
  under_way.subject = core::body_of(command.ask);
  under_way.has_time = command.at_step > 0;
  under_way.changes_the_run = core::changes_the_run(command.ask);
  const auto* const ray = std::get_if<core::Ray>(&command.ask);
  under_way.delivery.is_ray = ray != nullptr;
  if (ray != nullptr) under_way.asked = ray->regions;
  under_way.delivery.distance_m = std::numeric_limits<double>::infinity();
  under_way.deadline =
      Clock::now() + (under_way.delivery.is_ray ? kPatienceForRays : Clock::duration(kPatienceForAnswers));
  // Any map: there is one run in a domain, and its map may be changing just now.
  const std::uint64_t request = endpoint_.send(std::move(command), 0);
  under_way.delivery.request = request;
  under_way_.emplace(request, std::move(under_way));
  return request;
}

void CommandClient::note(const core::CommandReply& reply, UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  switch (reply.outcome) {
    case core::Outcome::kAccepted:
      under_way.accepted = true;
      under_way.deadline = Clock::now() + (under_way.changes_the_run ? kPatienceForChanges : kPatienceAfterIt);
      delivery.at_step = reply.at_step;
      delivery.object = reply.object;
      return;
    case core::Outcome::kDone:
      delivery.done = true;
      delivery.at_step = reply.at_step;
      delivery.text = fmt::format("done at step {}", reply.at_step);
      under_way.deadline = {};
      return;
    case core::Outcome::kRefused:
      delivery.text = reply.text;
      under_way.deadline = {};
      return;
    case core::Outcome::kSeen:
      under_way.answered.push_back(reply.source);
      delivery.at_step = std::max(delivery.at_step, reply.at_step);
      if (!reply.object || reply.distance_m >= delivery.distance_m) return;
      delivery.object = reply.object;
      delivery.p_W = reply.p_W;
      delivery.normal_W = reply.normal_W;
      delivery.distance_m = reply.distance_m;
      return;
  }
}

bool CommandClient::has_ended(UnderWay& under_way) {
  Delivery& delivery = under_way.delivery;
  const bool late = Clock::now() >= under_way.deadline;
  if (delivery.is_ray) {
    delivery.silent.clear();
    const auto is_in = [](const auto& regions, core::RegionId region) {
      return std::ranges::find(regions, region) != regions.end();
    };
    for (const dds::Status* node : live_nodes()) {
      const bool asked = under_way.asked.empty() || is_in(under_way.asked, node->region);
      if (asked && !is_in(under_way.answered, node->region)) delivery.silent.push_back(node->region);
    }
    if (!late && (!delivery.silent.empty() || under_way.answered.empty())) return false;
    delivery.done = !under_way.answered.empty();
    delivery.text = delivery.done ? "" : "no region has answered";
    return true;
  }
  if (under_way.accepted && under_way.has_time && !delivery.done) {
    delivery.done = true;
    delivery.text = fmt::format("takes effect in step {}", delivery.at_step);
    return true;
  }
  if (!late) {
    const auto live = live_nodes();
    const bool paused = !live.empty() && std::ranges::all_of(live, [](const dds::Status* node) {
      return node->state == dds::NodeState::kPaused;
    });
    if (!under_way.accepted || under_way.changes_the_run || !paused) return false;  // nodes also stand to change
    delivery.done = true;
    delivery.text = fmt::format("the run is paused; takes effect in step {}", delivery.at_step);
    return true;
  }
  if (!delivery.text.empty()) return true;
  delivery.text = !under_way.accepted ? "no node has taken it"
                  : under_way.subject ? fmt::format("there is no body {}", core::value_of(*under_way.subject))
                                      : "it was taken, but nobody has shown its effect";
  return true;
}

std::vector<Delivery> CommandClient::take() {
  for (const core::CommandReply& reply : endpoint_.take()) {
    const auto found = under_way_.find(reply.request);
    if (found != under_way_.end()) note(reply, found->second);
  }
  std::vector<Delivery> ended;
  for (auto entry = under_way_.begin(); entry != under_way_.end();) {
    if (!has_ended(entry->second)) {
      ++entry;
      continue;
    }
    ended.push_back(std::move(entry->second.delivery));
    entry = under_way_.erase(entry);
  }
  return ended;
}

}  // namespace aurasim::cli
