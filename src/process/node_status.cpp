#include "process/node_status.h"

#include <algorithm>
#include <span>
#include <utility>

#include "process/exchange_choice.h"
#include "records/durations.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kWindow = 1s;
constexpr auto kAwaitedPeriod = messages::status_period(1);  ///< between two statuses that others wait for

messages::Durations summary_of(std::vector<double>& values) {
  return {records::percentile(values, 0.5), records::percentile(values, 0.99), records::percentile(values, 1)};
}

}  // namespace

void FrameWindow::note(double frame_ms, const node::Durations& durations, Clock::time_point now) {
  if (now - begin_ > kWindow) *this = FrameWindow(now);
  frame_.push_back(frame_ms);
  physics_.push_back(1e3 * durations.physics_s);
  protocol_.push_back(1e3 * durations.protocol_s);
  transport_.push_back(1e3 * durations.transport_s);
}

void FrameWindow::note_exchanges(std::span<const double> seconds) {
  for (const double one : seconds) exchange_.push_back(1e3 * one);
}

void FrameWindow::summarize(messages::Status& status) {
  status.frame = summary_of(frame_);
  status.physics = summary_of(physics_);
  status.protocol = summary_of(protocol_);
  status.transport = summary_of(transport_);
  status.exchange_times = summary_of(exchange_);
}

void NodeStatus::use_regions(const config::Launch& launch) {
  period_ = messages::status_period(launch.regions.size());
  status_.map_version = launch.regions.version();
  status_.footprint = launch.regions.region(status_.region);
}

void NodeStatus::use_exchange(const config::Launch& launch) {
  status_.exchange = in_use(launch.exchange);
  status_.lookahead = launch.lookahead();
  make_due();  // the others wait for it
}

void NodeStatus::note_step(const node::StepReport& report, double frame_ms, Clock::time_point now) {
  window_.note(frame_ms, report.durations, now);
  status_.bodies = report.bodies;
  status_.awake = report.awake;
  status_.foreign_auras = report.foreign_auras;
  status_.largest_cluster = report.largest_cluster;
  note_moved(report);
}

void NodeStatus::note_moved(const node::StepReport& moved) {
  status_.hand_offs_out += moved.departures.size();
  status_.hand_offs_in += moved.arrivals.size();
}

void NodeStatus::note_node(const node::Node& node) {
  const core::ViolationLog& log = node.protocol().violations();
  status_.violations = {log.count(core::ViolationKind::kSpeed), log.count(core::ViolationKind::kLatency),
                        log.count(core::ViolationKind::kFrame), log.count(core::ViolationKind::kPromise),
                        log.count(core::ViolationKind::kSpan)};
  status_.late_collisions = node.collision_watch().late();
  status_.missed_collisions = node.collision_watch().missed();
  status_.dead = node.protocol().intake().dead_regions();
  const std::span<const core::Listened> listens_to = node.protocol().listens_to();
  status_.listens_to.assign(listens_to.begin(), listens_to.end());
  window_.summarize(status_);
}

void NodeStatus::note_unreachable(std::vector<core::RegionId> unreachable) {
  if (unreachable == status_.dead) return;
  status_.dead = std::move(unreachable);
  make_due();
}

void NodeStatus::note_refused_strangers(std::uint64_t count) {
  std::erase_if(status_.refused, [](const auto& refused) { return refused.first == messages::kNoRegion; });
  if (count > 0) status_.refused.emplace_back(messages::kNoRegion, count);
}

std::uint64_t NodeStatus::refused_of(core::RegionId region) const {
  const auto entry = std::ranges::find(status_.refused, region, &std::pair<core::RegionId, std::uint64_t>::first);
  return entry == status_.refused.end() ? 0 : entry->second;
}

bool NodeStatus::period_is_over(Clock::time_point now) const { return now - published_ >= period_; }

bool NodeStatus::is_due(messages::NodeState state, Clock::time_point now) const {
  return state != status_.state || period_is_over(now);
}

bool NodeStatus::is_awaited(const Awaited& awaited, Clock::time_point now) const {
  return awaited != awaited_ && now - published_ >= kAwaitedPeriod;
}

void NodeStatus::note_published(messages::NodeState state, const Awaited& awaited, Clock::time_point now) {
  published_ = now;
  awaited_ = awaited;
  status_.state = state;
}

}  // namespace aurasim::process
