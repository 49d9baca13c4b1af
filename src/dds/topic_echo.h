// Samples of any topic of a run as JSON, for people and scripts. Knows no topic by itself: names and kinds of members
// come from the TypeObjects that every process publishes, through Fast DDS's dynamic types.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dds/participant.h"
#include "topics/topics.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class TopicEcho {
 public:
  /// Reads `topic` in partitions that match `partition` ("region/*", "world", "*"). Throws DdsError when
  /// there can be no reader.
  TopicEcho(Participant& participant, topics::TopicId topic, const std::string& partition);
  ~TopicEcho();

  /// Returns the next sample, or nothing if none has arrived. Members are in the order of the IDL; infinite numbers are
  /// null.
  std::optional<nlohmann::ordered_json> take();
  /// Returns when something has come, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
