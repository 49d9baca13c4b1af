// The table of topics: name, type, partitions, who may publish and read. Endpoints (dds/), permissions (security/),
// `aurasim echo` and the table of docs/protocol.md come from it. The quality of service of a topic is in its profiles,
// <name>_writer and <name>_reader of qos/aurasim.xml.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/ids.h"

namespace aurasim::topics {

enum class TopicId : std::uint8_t {
  kAura,
  kMigration,
  kNodeStatus,
  kRegionMap,
  kRunControl,
  kReplica,
  kReplicaKey,
  kClusterGraph,
  kCommand,
  kCommandReply,
  kShape,
  kInterest,
  kObservation,
  kOrders,
  kControl,
  kCheckpoint,
  kSeam,
  kProbe
};
inline constexpr std::size_t kTopicCount = 18;

/// How the messages of a topic are divided into partitions.
enum class Division : std::uint8_t {
  kNone,             ///< all in partition world
  kBySource,         ///< region/<source>
  kByPair,           ///< region/<source>/to/<destination>
  kByPairAndToAll,   ///< region/<source>/to/<destination>, and world for messages to all
  kBySourceAndUser,  ///< region/<source>/observer/<client>
};

/// Kinds of processes that publish or read; a process with the key of a recorder reads everything.
enum Party : std::uint8_t {
  kNodes = 1,
  kOperators = 2,  ///< programs and people that ask something of the run
  kViewers = 4,    ///< programs that observe the run; operators among them
};

struct Topic {
  TopicId id;
  const char* name;  ///< also the first part of its profiles' names
  const char* type;  ///< in idl/aurasim.idl
  Division division;
  /// Partitions are different ones after a death or a change of the run: they end in /since/<generation>.
  bool by_life;
  std::uint8_t published_by;  ///< set of Party
  std::uint8_t read_by;       ///< set of Party
  const char* carries;        ///< for docs/protocol.md
};

/// All topics, in the order of TopicId.
std::span<const Topic> all();
const Topic& at(TopicId id);
const char* name_of(TopicId id);
std::optional<TopicId> topic_named(std::string_view name);

inline constexpr const char* kWorldPartition = "world";

/// From whom to whom messages go. What is not given is any: then the partition is a pattern.
struct Route {
  std::optional<core::RegionId> source = {};
  std::optional<core::RegionId> destination = {};  ///< for Division::kByPair and kByPairAndToAll
  std::optional<std::uint64_t> observer = {};      ///< for Division::kBySourceAndUser: random number of the client
  /// Generation with which the run went on after the last death or change; 0: none yet. For topics with by_life.
  core::Generation life = 0;
};

/// Returns the partition of a topic for a route: a name, or a pattern as in fnmatch, whose `*` matches `/` too. For
/// Division::kByPairAndToAll it is the one between two regions; kWorldPartition is the other.
std::string partition_of(TopicId topic, const Route& route = {});
/// Returns the pattern for `partition` in all lives but the first.
std::string in_later_lives(const std::string& partition);

/// True for messages of nodes to all nodes. With `dds.discovery: neighbours` they go to the hub of the run, and from it
/// to all: they are published in to_hub(partition), and the hub publishes them in the partition itself.
bool goes_by_hub(TopicId topic, std::string_view partition);
std::string to_hub(std::string_view partition);
/// The hub reads partitions whose names begin with kToHub; kEveryPartitionToHub is the pattern of all of them.
inline constexpr std::string_view kToHub = "hub/";
inline constexpr const char* kEveryPartitionToHub = "hub/*";
/// In a run with keys the hub publishes in this partition instead. Only the role `hub` may publish there, so a sample
/// that comes in it is known to come from the hub.
inline constexpr const char* kFromHub = "from_hub";
/// True if the hub passes on messages of this topic, in whatever partition.
inline bool has_way_by_hub(TopicId topic) { return goes_by_hub(topic, kWorldPartition); }

/// Returns all partitions in which a topic is published before the first death or change, in a run of `regions`
/// regions. Those for observers are a pattern for each region.
std::vector<std::string> partitions_in_run(TopicId topic, std::size_t regions);
/// Returns one pattern that matches all partitions of a topic.
std::string every_partition_of(TopicId topic);

/// Returns the rows of the table as JSON, for scripts/topics_table.py: name, type, partitions, published_by, read_by
/// and carries.
std::string as_json();

}  // namespace aurasim::topics
