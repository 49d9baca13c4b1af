// Which clusters leave this region after a state, and to which one.
#include <algorithm>
#include <utility>

#include "core/horizon.h"
#include "core/progress.h"
#include "core/protocol.h"

namespace aurasim::core {
namespace {

/// Clusters are added to a departure while it has at most so many bodies: a message that fits into one datagram is the
/// cheapest.
constexpr std::size_t kMostMerged = 32;

/// Unites clusters that leave for one destination for one reason: one message takes less time than several, and so does
/// one world in which they make up states.
void merge(std::vector<Departure>& departures) {
  auto end = departures.begin();
  for (Departure& departure : departures) {
    const auto same = std::find_if(departures.begin(), end, [&](const Departure& other) {
      return other.destination == departure.destination && other.reason == departure.reason &&
             other.bodies.size() + departure.bodies.size() <= kMostMerged;
    });
    if (same != end) {
      same->bodies.insert(same->bodies.end(), departure.bodies.begin(), departure.bodies.end());
    } else {
      if (&*end != &departure) *end = std::move(departure);
      ++end;
    }
  }
  departures.erase(end, departures.end());
  for (Departure& departure : departures) std::ranges::sort(departure.bodies);
}

}  // namespace

void Protocol::decide(const Snapshot& snapshot) {
  goes_home_.resize(snapshot.bodies.size());
  homing_.clear();
  largest_cluster_ = 0;
  if (aura_->warns()) {
    decide_for_clusters(snapshot);
  } else {
    for (std::uint32_t i = 0; i < snapshot.bodies.size(); ++i) decide_naively(i, snapshot);
  }
  merge(departing_);
}

void Protocol::decide_for_clusters(const Snapshot& snapshot) {
  list_complete_clusters();
  for (const std::uint32_t i : matching_.all_outside()) {
    largest_cluster_ = std::max(largest_cluster_, matching_.clusters().size(i));
    if (!matching_.clusters().is_complete(i)) projection_.track(i).island_since = -1;  // a part of it is inside
  }
  for (const auto& [first, cluster] : complete_) {
    Progress::mark();
    largest_cluster_ = std::max(largest_cluster_, matching_.clusters().size(first));
    decide_for_cluster(first, snapshot);
  }
  send_home(snapshot);
  for (const auto& [first, cluster] : complete_) goes_home_[cluster] = 0;
}

/// Lists the complete clusters in ascending order of their first bodies.
void Protocol::list_complete_clusters() {
  const Clusters& clusters = matching_.clusters();
  complete_.clear();
  for (const std::uint32_t i : clusters.completed()) complete_.push_back({0, clusters.of(i)});
  std::ranges::sort(complete_, {}, &CompleteCluster::cluster);
  const auto twins = std::ranges::unique(complete_, {}, &CompleteCluster::cluster);
  complete_.erase(twins.begin(), twins.end());
  for (CompleteCluster& one : complete_) {
    one.first = one.cluster;
    clusters.for_each_member(one.cluster, [&](std::uint32_t j) { one.first = std::min(one.first, j); });
  }
  std::ranges::sort(complete_, {}, &CompleteCluster::first);
}

/// Decides AC before BT, because a cluster that an aura has met is never an island.
void Protocol::decide_for_cluster(std::uint32_t i, const Snapshot& snapshot) {
  const RegionId pulled_to = matching_.pulled_to(i);
  if (pulled_to != vicinity_.self) {
    depart(i, pulled_to, HandOffReason::kAuraCollision, snapshot);
  } else if (settles_elsewhere(i, snapshot.step)) {
    homing_.push_back(i);
    goes_home_[matching_.clusters().of(i)] = 1;
  }
}

/// Sends home the clusters that no body that stays here may meet. Others would be pulled back at once.
void Protocol::send_home(const Snapshot& snapshot) {
  if (homing_.empty()) return;
  const Clusters& clusters = matching_.clusters();
  const auto stays = [&](std::uint32_t other) { return !goes_home_[clusters.of(other)]; };
  const auto leaves_somebody = [&](std::uint32_t i) {
    if (!clusters.any_near(i, horizon::kHomewardHops, stays)) return false;
    goes_home_[clusters.of(i)] = 0;
    return true;
  };
  while (std::erase_if(homing_, leaves_somebody) > 0) Progress::mark();
  const std::vector<RegionId> dead = intake_.dead_regions();
  for (const std::uint32_t i : homing_) {
    const RegionId home = lowest_owner(i);
    if (vicinity_.is_neighbour(home) && std::ranges::find(dead, home) == dead.end()) {
      depart(i, home, HandOffReason::kBoundaryTraversal, snapshot);
    }
  }
}

void Protocol::decide_naively(std::uint32_t i, const Snapshot& snapshot) {
  const RegionId owner = vicinity_.map.owner(snapshot.bodies[i].pose.p_WB);
  if (owner != vicinity_.self && vicinity_.is_neighbour(owner)) {
    depart(i, owner, HandOffReason::kBoundaryTraversal, snapshot);
  }
}

/// Has the cluster of body i been an island for long enough?
bool Protocol::settles_elsewhere(std::uint32_t i, Step now) {
  const bool island = !matching_.touched(i) && !matching_.expected(i) && matching_.clusters().is_outside(i);
  Step since = 0;
  matching_.clusters().for_each_member(i, [&](std::uint32_t j) {
    Track& track = projection_.track(j);
    if (!island) {
      track.island_since = -1;
    } else if (track.island_since < 0) {
      track.island_since = now;
    }
    since = std::max(since, track.island_since);
  });
  return island && now - since >= horizon::homecoming(aura_->rules().lookahead, aura_->rules().redo);
}

RegionId Protocol::lowest_owner(std::uint32_t i) const {
  RegionId lowest{~0u};
  matching_.clusters().for_each_member(
      i, [&](std::uint32_t j) { lowest = std::min(lowest, vicinity_.map.owner(matching_.path(j).pose.p_WB)); });
  return lowest;
}

/// Nothing goes to a region that may have ceased to listen before it has said that the cluster has arrived. The pair is
/// seen again in the next state, and its territory's owner introduces the two anew. Where they touch first, states are
/// computed again.
void Protocol::depart(std::uint32_t i, RegionId destination, HandOffReason reason, const Snapshot& snapshot) {
  if (!listening_.stays(destination, snapshot.step)) return;
  Departure& departure = departing_.emplace_back();
  departure.destination = destination;
  departure.reason = reason;
  const bool collision = reason == HandOffReason::kAuraCollision;
  matching_.clusters().for_each_member(i, [&](std::uint32_t j) {
    departure.bodies.push_back(snapshot.bodies[j].id);
    projection_.depart(snapshot.bodies[j], j, destination, collision ? PhaseEvent::kAuraHit : PhaseEvent::kIsland,
                       outbox_.aura);
  });
}

void Protocol::hand_over(const Departure& departure, ClusterState cluster) {
  for (BodyRecord& body : cluster.bodies) ++body.epoch;
  counters_.handed_over += cluster.bodies.size();
  HandOff hand_off;
  hand_off.source = vicinity_.self;
  hand_off.destination = departure.destination;
  hand_off.generation = settings_.generation;
  hand_off.redo = settings_.redo;
  hand_off.stamp = outbox_.aura.stamp;
  hand_off.map_version = map_version_;
  hand_off.reason = departure.reason;
  hand_off.cluster = std::move(cluster);
  const HandOff& kept = departures_.record(std::move(hand_off));
  outbox_.hand_offs.push_back(kept);
  std::erase_if(outbox_.aura.hand_offs, [&](const HandOffMark& m) { return m.region == kept.destination; });
  outbox_.aura.hand_offs.push_back({kept.destination, kept.sequence});
}

}  // namespace aurasim::core
