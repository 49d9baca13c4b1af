#include "lab/scenes/play.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "cut/cut_file.h"

namespace aurasim::lab {

core::WorldCut through_a_file(core::WorldCut cut) {
  return cut::decode(cut::encode({{}, 0, 1, 0, std::move(cut)})).cut;
}

void Saver::begin(VirtualCluster& cluster) const {
  for (std::size_t r = 0; r < cluster.size(); ++r) cluster.node(r).save(step_);
}

void Saver::collect(node::Node& node) {
  for (core::WorldCut& part : node.take_saved()) parts_.push_back(through_a_file(std::move(part)));
}

core::WorldCut Saver::take(std::size_t regions) {
  if (parts_.size() != regions) {
    throw std::runtime_error(fmt::format("{} of {} regions have saved their parts", parts_.size(), regions));
  }
  return through_a_file(core::merge(std::move(parts_)));
}

void note_report(const node::StepReport& report, Played& played) {
  for (const node::HashPart& part : report.hash) {
    if (part.step < static_cast<core::Step>(played.hash.size())) {
      played.hash[static_cast<std::size_t>(part.step)] += part.sum;
    }
  }
  played.hand_offs += report.departures.size();
  played.largest_cluster = std::max(played.largest_cluster, report.largest_cluster);
  for (const physics::Removal& removal : report.removals) {
    if (removal.fault.empty()) continue;
    if (played.broken++ > 0) continue;
    played.first_fault =
        fmt::format("body {} in state {}: {}", core::value_of(removal.body), removal.step, removal.fault);
  }
}

void note_redo(const VirtualCluster::Event& event, Played& played) {
  if (!event.report->put_back_from || event.region != core::RegionId{0}) return;
  ++played.redos;
  played.again += static_cast<std::uint64_t>(*event.report->put_back_from - event.report->step);
}

std::optional<Played> play(VirtualCluster& cluster, Interference& interference, core::Step steps, int lookahead,
                           const std::atomic<bool>& stop, Saver* saver, const core::WorldCut* world) {
  const core::Step more = 4 * lookahead + 2;  // by then, all bodies under way have arrived
  Played played;
  played.hash.assign(static_cast<std::size_t>(steps) + 1, 0);
  const double begin_s = thread_time_s();
  const auto note_reports = [&](std::span<const node::StepReport> reports) {
    for (const node::StepReport& report : reports) note_report(report, played);
  };
  for (std::size_t r = 0; r < cluster.size(); ++r) note_reports(cluster.node(r).confirmed());
  ImpatientClient client(interference.requests);
  Programs programs(interference.words, cluster, world != nullptr ? world->step : 0);
  if (saver != nullptr) saver->begin(cluster);
  if (world != nullptr) client.speak_after(*world, cluster.node(0));
  while (cluster.slowest() < steps + more || cluster.confirmed() < steps) {
    if (stop) return std::nullopt;
    if (world == nullptr) client.speak(cluster.node(0));
    programs.speak();
    const VirtualCluster::Event event = cluster.next();
    if (saver != nullptr) saver->collect(cluster.node(core::value_of(event.region)));
    note_reports(cluster.node(core::value_of(event.region)).confirmed());
    note_redo(event, played);
  }
  for (std::size_t r = 0; r < cluster.size(); ++r) note_reports(cluster.node(r).finish(steps + more));
  for (std::size_t r = 0; r < cluster.size(); ++r) played.bodies += cluster.node(r).report().bodies;
  played.cpu_s = thread_time_s() - begin_s;
  return played;
}

}  // namespace aurasim::lab
