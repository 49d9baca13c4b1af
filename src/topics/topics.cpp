#include "topics/topics.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace aurasim::topics {
namespace {

constexpr std::array<Topic, kTopicCount> kTopics = {{
    {TopicId::kAura, "aura", "aurasim::wire::AuraBatch", Division::kBySource, true, kNodes, kNodes | kViewers,
     "one per node and step, even if empty: \"state n is done\"; auras, orders"},
    {TopicId::kMigration, "migration", "aurasim::wire::Migration", Division::kByPair, true, kNodes, kNodes,
     "clusters change host"},
    {TopicId::kNodeStatus, "node_status", "aurasim::wire::NodeStatus", Division::kBySource, false, kNodes,
     kNodes | kViewers, "ten times a second, of more than 10 nodes less often: state, counts, times"},
    {TopicId::kRegionMap, "region_map", "aurasim::wire::RegionMap", Division::kNone, false, kNodes, kNodes | kViewers,
     "who owns what, and what all must agree on"},
    {TopicId::kRunControl, "run_control", "aurasim::wire::RunControl", Division::kNone, false, kNodes | kOperators,
     kNodes | kOperators,
     "start, pause, resume, step, reset, stop, rate; lost, restore, drain, take, end: see [Going back](#going-back)"},
    {TopicId::kReplica, "replica", "aurasim::wire::Replica", Division::kBySource, false, kNodes, kViewers,
     "for observers: what has changed since the last tick"},
    {TopicId::kReplicaKey, "replica_key", "aurasim::wire::Replica", Division::kBySource, false, kNodes, kViewers,
     "for observers: everything"},
    {TopicId::kClusterGraph, "cluster_graph", "aurasim::wire::ClusterGraph", Division::kBySource, false, kNodes,
     kViewers, "only while somebody listens: links of clusters and contacts, for drawing them"},
    {TopicId::kCommand, "command", "aurasim::wire::Command", Division::kNone, false, kOperators, kNodes,
     "from clients: what is asked of the world"},
    {TopicId::kCommandReply, "command_reply", "aurasim::wire::CommandReply", Division::kNone, false, kNodes, kOperators,
     "accepted, done, refused, or a region's answer to a ray"},
    {TopicId::kShape, "shape", "aurasim::wire::MeshShape", Division::kNone, false, kNodes | kOperators,
     kNodes | kViewers, "a client's mesh, by its content; also from the lead, published again (stamp 1)"},
    {TopicId::kInterest, "interest", "aurasim::wire::Interest", Division::kNone, false, kViewers, kNodes,
     "which bodies one observer asks for; of each observer the newest counts"},
    {TopicId::kObservation, "observation", "aurasim::wire::Observation", Division::kBySourceAndUser, false, kNodes,
     kViewers, "to that observer: what the region has of it, one for each state"},
    {TopicId::kOrders, "orders", "aurasim::wire::AuraBatch", Division::kNone, false, kNodes, kViewers,
     "from the lead, for observers: all orders so far that add to the scene; of those that send a static the newest, "
     "and the last half second's"},
    {TopicId::kControl, "control", "aurasim::wire::Setpoints", Division::kNone, false, kOperators, kNodes,
     "setpoints of programs for bodies, joints and statics, from a state on: see [Setpoints](#setpoints)"},
    {TopicId::kCheckpoint, "checkpoint", "aurasim::wire::Checkpoint", Division::kByPairAndToAll, true, kNodes, kNodes,
     "a region's part of the world in one state, as in a file: to be kept, or to go back to"},
    {TopicId::kSeam, "seam", "aurasim::wire::SeamPiece", Division::kByPair, true, kNodes, kNodes,
     "where regions are coupled, several in each step: bodies near the border, and movers of common contacts"},
    {TopicId::kProbe, "probe", "aurasim::wire::SeamPiece", Division::kByPair, false, kNodes, kNodes,
     "before the start of a run with `exchange: auto`: questions of region 0 and the answers, to measure round trips"},
}};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    if (kTopics[i].id != static_cast<TopicId>(i)) return false;
  }
  return true;
}
static_assert(is_in_order());

std::string text_of(const std::optional<core::RegionId>& region) {
  return region ? fmt::format("{}", core::value_of(*region)) : "*";
}

}  // namespace

std::span<const Topic> all() { return kTopics; }

const Topic& at(TopicId id) { return kTopics.at(static_cast<std::size_t>(id)); }

const char* name_of(TopicId id) { return at(id).name; }

std::optional<TopicId> topic_named(std::string_view name) {
  const auto found = std::ranges::find_if(kTopics, [&](const Topic& topic) { return topic.name == name; });
  if (found == kTopics.end()) return std::nullopt;
  return found->id;
}

std::string partition_of(TopicId id, const Route& route) {
  const Topic& topic = at(id);
  std::string partition = "region/" + text_of(route.source);
  switch (topic.division) {
    case Division::kNone:
      return kWorldPartition;
    case Division::kBySource:
      break;
    case Division::kByPair:
    case Division::kByPairAndToAll:
      partition += "/to/" + text_of(route.destination);
      break;
    case Division::kBySourceAndUser:
      partition += "/observer/" + (route.observer ? fmt::format("{:016x}", *route.observer) : "*");
  }
  return topic.by_life && route.life != 0 ? fmt::format("{}/since/{}", partition, route.life) : partition;
}

std::string in_later_lives(const std::string& partition) { return partition + "/since/*"; }

bool goes_by_hub(TopicId topic, std::string_view partition) {
  switch (topic) {
    case TopicId::kNodeStatus:
    case TopicId::kRegionMap:
    case TopicId::kRunControl:
      return true;
    case TopicId::kCheckpoint:  // those to keepers go straight there
      return partition == kWorldPartition;
    default:
      return false;
  }
}

std::string to_hub(std::string_view partition) { return std::string(kToHub).append(partition); }

std::vector<std::string> partitions_in_run(TopicId topic, std::size_t regions) {
  const Division division = at(topic).division;
  if (division == Division::kNone) return {kWorldPartition};
  const bool by_pair = division == Division::kByPair || division == Division::kByPairAndToAll;
  std::vector<std::string> partitions;
  for (std::uint32_t source = 0; source < regions; ++source) {
    for (std::uint32_t to = 0; to < (by_pair ? regions : 1); ++to) {
      partitions.push_back(partition_of(topic, {.source = core::RegionId{source}, .destination = core::RegionId{to}}));
    }
  }
  return partitions;
}

std::string every_partition_of(TopicId topic) {
  const Division division = at(topic).division;
  if (division == Division::kNone) return kWorldPartition;
  return division == Division::kByPairAndToAll ? "*" : "region/*";
}

std::string as_json() {
  const auto text_of_parties = [](std::uint8_t parties) {
    std::vector<std::string> names;
    if (parties & kNodes) names.emplace_back("nodes");
    if (parties & kOperators) names.emplace_back("operators");
    if (parties & kViewers) names.emplace_back("viewers");
    return names;
  };
  constexpr std::array kDivisions = {"`world`", "`region/<src>`", "`region/<src>/to/<dst>`",
                                     "`region/<src>/to/<dst>`, `world`", "`region/<src>/observer/<client>`"};
  auto rows = nlohmann::ordered_json::array();
  for (const Topic& topic : kTopics) {
    rows.push_back({{"name", topic.name},
                    {"type", topic.type},
                    {"partition", kDivisions.at(static_cast<std::size_t>(topic.division))},
                    {"by_life", topic.by_life},
                    {"published_by", text_of_parties(topic.published_by)},
                    {"read_by", text_of_parties(topic.read_by)},
                    {"carries", topic.carries}});
  }
  return rows.dump(1) + "\n";
}

}  // namespace aurasim::topics
