// Limits retransmissions. Nodes of the run get all that they ask for. Other processes get a limited number of bytes a
// second, and after a while no messages between nodes: a reader that takes no samples asks for all of them with each
// heartbeat, for ever, and they are kept for it. Pure; time is passed in.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/token_bucket.h"
#include "rtps/datagram_findings.h"
#include "rtps/recent.h"

namespace aurasim::rtps {

/// Limits for processes that are no nodes. A viewer with 10% loss asks each node for some kB a second, a spare that
/// joins late for some 20 MB at once.
struct RepeatLimits {
  double bytes_per_s = 8e6, bytes_burst = 32e6;            ///< limits of one process
  double all_bytes_per_s = 32e6, all_bytes_burst = 128e6;  ///< limits of all together; discovery is not counted
  double smallest_sample_B = 2048;                         ///< lowest cost of a retransmission
  /// Time in which a reader of messages between nodes has to become known as a node.
  core::TokenBucket::Time until_known = std::chrono::seconds(10);
};

class Repeats {
 public:
  using Time = core::TokenBucket::Time;
  using Prefixes = std::unordered_set<GuidPrefix, PrefixHash>;

  explicit Repeats(const RepeatLimits& limits)
      : limits_(limits), all_(limits.all_bytes_per_s, limits.all_bytes_burst, Time(0)) {}

  /// Sets the nodes of the run, the own process excluded. While the set is empty every process counts as a node.
  void set_nodes(Prefixes nodes) { nodes_ = std::move(nodes); }
  /// Registers a writer of this process whose samples only nodes need.
  void add_writer_of_nodes(std::uint32_t writer) { of_nodes_.insert(writer); }
  void remove_writer_of_nodes(std::uint32_t writer) { of_nodes_.erase(writer); }

  /// Takes note of a sample that this process sends.
  void note_sent(std::uint32_t writer, std::uint64_t number, std::uint32_t sample_B);

  enum class Answer : std::uint8_t {
    kPass,
    kDrop,    ///< not answered now; a later request may be answered
    kHasAll,  ///< treated as if it had acknowledged all samples up to last_of()
  };
  Answer judge(const Request& request, Time now);
  std::uint64_t last_of(std::uint32_t writer) const;

  /// Processes that were refused retransmissions, or from which no acknowledgement is awaited any more, for the first
  /// time since the last call.
  std::vector<std::pair<GuidPrefix, Answer>> take_news() { return std::exchange(news_, {}); }

  static constexpr std::size_t kMostAskers = 2048, kMostWriters = 65'536, kMostNews = 64;

 private:
  struct Asker {
    core::TokenBucket bytes;
    Time since{0};  ///< first request of it for messages between nodes; 0: none so far
    bool is_said = false, is_said_of_nodes = false;
  };
  struct Sent {
    std::uint64_t last = 0;
    std::uint32_t sample_B = 0;  ///< recent maximum: the weight of a sample 100 samples ago is small
  };

  double price_of(const Request& request) const;
  bool is_too_late(Asker& asker, const Request& request, Time now) const;
  void tell(bool& is_said, const Request& request, Answer answer);

  RepeatLimits limits_;
  Prefixes nodes_;
  std::unordered_set<std::uint32_t> of_nodes_;
  std::unordered_map<std::uint32_t, Sent> sent_;
  Recent<GuidPrefix, Asker, PrefixHash> askers_;
  core::TokenBucket all_;
  std::vector<std::pair<GuidPrefix, Answer>> news_;
};

}  // namespace aurasim::rtps
