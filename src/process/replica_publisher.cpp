#include "process/replica_publisher.h"

#include <algorithm>

#include "node/cluster_graph.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kKeyFramePeriod = std::chrono::seconds(1);
constexpr auto kClusterGraphPeriod = std::chrono::milliseconds(250);  // period of the cluster graph in a paused run

}  // namespace

ReplicaPublisher::ReplicaPublisher(const config::Launch& launch, dds::Participant& participant, core::RegionId region)
    : region_(region),
      map_version_(launch.regions.version()),
      tick_steps_(node::tick_steps(launch.time.step_hz, launch.observe.tick_hz)),
      writer_(participant, region),
      graphs_(participant, region),
      observations_(launch, participant, region) {}

void ReplicaPublisher::begin_generation(core::Generation generation) {
  feed_.emplace(region_, generation, map_version_);
  generation_ = generation;
  composed_ = published_ = -1;
  held_.clear();
  observations_.begin_generation(generation, map_version_);
}

void ReplicaPublisher::put_back(core::Step step, core::Step confirmed) {
  held_.put_back(step, confirmed);
  if (feed_) feed_->forget();
  last_key_frame_ = {};
  composed_ = std::max(published_, std::min(composed_, step));
  observations_.put_back(step, confirmed);
}

void ReplicaPublisher::after_step(node::Node& node, const node::StepReport& report) {
  observations_.after_step(node, report);
  if (!writer_.anybody_listens()) {
    feed_->forget();
    held_.clear();
    composed_ = published_;
    return;
  }
  feed_->note(report);
  feed_->note(node.world().snapshot());
  if (report.step % tick_steps_ == 0 && report.step > composed_) compose(node);
  held_.give_out(node.shown_step());
}

void ReplicaPublisher::while_paused(node::Node& node) {
  observations_.while_paused(node);
  if (!writer_.anybody_listens()) return;
  // The cluster graph is repeated, because lost samples are not retransmitted.
  if (Clock::now() - last_graph_ >= kClusterGraphPeriod) publish_cluster_graph(node);
  if (node.shown_step() < node.current_step()) return;
  if (composed_ != node.current_step() || arrivals_ != writer_.arrivals() || key_frame_is_due()) compose(node);
  held_.give_out(node.shown_step());
}

/// True if a key frame is due. A new observer gets one at once, because the last one may be older than its arrival.
bool ReplicaPublisher::key_frame_is_due() const {
  if (arrivals_ != writer_.arrivals()) return true;
  return feed_->changed_since_key_frame() && Clock::now() - last_key_frame_ >= kKeyFramePeriod;
}

void ReplicaPublisher::publish_census(node::Node& node, core::Generation generation) {
  begin_generation(generation);
  writer_.send(feed_->compose_changes(node.world().snapshot()));  // a key frame follows a tick
  writer_.send(feed_->compose_key_frame(node.world().snapshot(), {}));
}

/// Composes the present state, which is published once it is certain.
void ReplicaPublisher::compose(node::Node& node) {
  const core::Snapshot& snapshot = node.world().snapshot();
  composed_ = snapshot.step;
  held_.add(composed_, [this, replica = feed_->compose_changes(snapshot)] {
    published_ = replica.stamp;
    writer_.send(replica);
  });
  publish_cluster_graph(node);
  if (!key_frame_is_due()) return;
  arrivals_ = writer_.arrivals();
  last_key_frame_ = Clock::now();
  held_.add(composed_, [this, replica = feed_->compose_key_frame(snapshot, node.protocol().departures().open())] {
    writer_.send(replica);
  });
}

void ReplicaPublisher::publish_cluster_graph(node::Node& node) {
  if (!graphs_.anybody_listens()) return;
  last_graph_ = Clock::now();
  graphs_.send(node::cluster_graph_of(node, generation_, map_version_));
}

}  // namespace aurasim::process
