#include "node/replica_feed.h"

#include <algorithm>
#include <cmath>

#include "core/keep_one_of_each.h"

namespace aurasim::node {
namespace {

// A body that has moved less than this since it was last published counts as not moved. The values are far below what
// can be seen, and far above the jitter of a body at rest that has not fallen asleep yet.
constexpr double kStillM = 1e-4;
constexpr float kStillQuaternion = 2e-4F;

bool ascending(const core::ReplicaBody& a, const core::ReplicaBody& b) { return a.id < b.id; }

bool is_here(const core::Snapshot& snapshot, core::BodyId id) {
  const core::BodyState* const body = core::find_body(snapshot.bodies, id);
  return body != nullptr && body->birth <= snapshot.step;
}

}  // namespace

core::Step tick_steps(double step_hz, double tick_hz) {
  return std::max<core::Step>(1, std::llround(step_hz / tick_hz));
}

ReplicaFeed::ReplicaFeed(core::RegionId self, core::Generation generation, std::uint64_t map_version)
    : self_(self), generation_(generation), map_version_(map_version) {}

void ReplicaFeed::note(const StepReport& report) {
  for (std::size_t i = 0; i < report.departed.size(); ++i) {
    const core::BodyRecord& body = report.departed[i];
    core::ReplicaBody row = core::replica_body(core::state_of(body), report.departures[i].destination);
    row.epoch = report.departures[i].epoch;
    left_.insert_or_assign(body.id, Left{row, body.birth});
  }
  // The host with the higher epoch publishes the body; this node forgets it without a message.
  for (const core::BodyId id : report.let_go) published_.erase(id);
}

void ReplicaFeed::note(const core::Snapshot& snapshot) {
  if (seen_ != 0 && snapshot.number == seen_) return;
  all_may_have_changed_ = all_may_have_changed_ || !snapshot.goes_on_from(seen_);
  seen_ = snapshot.number;
  if (all_may_have_changed_) return changed_.clear();
  for (const std::uint32_t i : snapshot.changed) changed_.push_back(snapshot.bodies[i].id);
}

bool ReplicaFeed::is_news(const core::BodyState& body) const {
  const auto found = published_.find(body.id);
  if (found == published_.end()) return true;
  const Published& published = found->second;
  return published.epoch != body.epoch || published.asleep == body.awake ||
         (published.p_WB - body.pose.p_WB).cwiseAbs().maxCoeff() > kStillM ||
         (published.q_WB.coeffs() - body.pose.q_WB.cast<float>().coeffs()).cwiseAbs().maxCoeff() > kStillQuaternion;
}

void ReplicaFeed::begin(core::Replica& replica, core::Step stamp, bool key_frame) const {
  replica.source = self_;
  replica.generation = generation_;
  replica.stamp = stamp;
  replica.map_version = map_version_;
  replica.sequence = sequence_;
  replica.key_frame = key_frame;
  replica.bodies.clear();
  replica.removed.clear();
}

const core::Replica& ReplicaFeed::compose_changes(const core::Snapshot& snapshot) {
  ++sequence_;
  begin(changes_, snapshot.step, false);
  note(snapshot);
  if (all_may_have_changed_) {
    for (const core::BodyState& body : snapshot.bodies) compose_change(body);
  } else {
    core::keep_one_of_each(changed_);
    for (const core::BodyId id : changed_) compose_change(*core::find_body(snapshot.bodies, id));
  }
  all_may_have_changed_ = snapshot.number == 0;
  changed_.clear();
  compose_departures();
  compose_removals(snapshot);
  changed_since_key_frame_ = changed_since_key_frame_ || !changes_.bodies.empty() || !changes_.removed.empty();
  return changes_;
}

void ReplicaFeed::compose_change(const core::BodyState& body) {
  if (body.birth > changes_.stamp || !is_news(body)) return;
  changes_.bodies.push_back(core::replica_body(body, self_));
  const core::ReplicaBody& row = changes_.bodies.back();
  published_.insert_or_assign(body.id, Published{row.epoch, row.asleep, row.p_WB, row.q_WB});
  left_.erase(body.id);  // the body has come back
}

void ReplicaFeed::compose_departures() {
  if (left_.empty()) return;
  std::erase_if(left_, [this](const auto& entry) {
    const auto& [id, left] = entry;
    if (left.birth > changes_.stamp) return false;
    published_.erase(id);
    changes_.bodies.push_back(left.row);
    return true;
  });
  std::sort(changes_.bodies.begin(), changes_.bodies.end(), ascending);
}

void ReplicaFeed::compose_removals(const core::Snapshot& snapshot) {
  const auto is_born = [&](const core::BodyState& body) { return body.birth <= snapshot.step; };
  const auto born =
      snapshot.number != 0 ? snapshot.born : static_cast<std::size_t>(std::ranges::count_if(snapshot.bodies, is_born));
  if (published_.size() == born) return;
  for (const auto& [id, published] : published_) {
    if (!is_here(snapshot, id)) changes_.removed.push_back({id, published.epoch});
  }
  std::sort(changes_.removed.begin(), changes_.removed.end(),
            [](const core::RemovedBody& a, const core::RemovedBody& b) { return a.id < b.id; });
  for (const core::RemovedBody& body : changes_.removed) published_.erase(body.id);
}

const core::Replica& ReplicaFeed::compose_key_frame(const core::Snapshot& snapshot,
                                                    const std::deque<core::HandOff>& under_way) {
  begin(all_, snapshot.step, true);
  for (const core::BodyState& body : snapshot.bodies) {
    if (body.birth <= snapshot.step) all_.bodies.push_back(core::replica_body(body, self_));
  }
  const std::size_t hosted = all_.bodies.size();
  for (const core::HandOff& hand_off : under_way) {
    for (const core::BodyRecord& body : hand_off.cluster.bodies) {
      if (body.birth <= snapshot.step && !is_here(snapshot, body.id))
        all_.bodies.push_back(core::replica_body(core::state_of(body), hand_off.destination));
    }
  }
  // A body that left twice is on its way under the higher epoch.
  std::sort(all_.bodies.begin(), all_.bodies.end(), [](const core::ReplicaBody& a, const core::ReplicaBody& b) {
    return a.id != b.id ? a.id < b.id : a.epoch > b.epoch;
  });
  if (all_.bodies.size() > hosted) {
    const auto same = [](const core::ReplicaBody& a, const core::ReplicaBody& b) { return a.id == b.id; };
    all_.bodies.erase(std::unique(all_.bodies.begin(), all_.bodies.end(), same), all_.bodies.end());
  }
  changed_since_key_frame_ = false;
  return all_;
}

void ReplicaFeed::forget() {
  published_.clear();
  left_.clear();
  changed_since_key_frame_ = true;
  all_may_have_changed_ = true;
}

}  // namespace aurasim::node
