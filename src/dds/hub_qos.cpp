#include "dds/hub_qos.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "messages/guarded_type.h"
#include "messages/status_period.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DataWriterQos;

namespace {

/// A writer of a hub has an instance for each source of its samples, and any number of sources.
void make_room_for_sources(DataWriterQos& qos) {
  auto& limits = qos.resource_limits();
  limits.max_instances = static_cast<std::int32_t>(messages::kMostKeys) + 1;
  limits.max_samples_per_instance = qos.history().depth;
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  limits.max_samples =
      static_cast<std::int32_t>(std::min(kMost, std::int64_t{limits.max_instances} * limits.max_samples_per_instance));
}

/// Sends several samples in one datagram when they come faster than they are sent, and lets readers acknowledge now and
/// then instead of each sample. For topics whose next sample replaces the last. On a busy host the hub has no more of a
/// processor than each of the nodes, and it serves them all.
void spare_the_hub(DataWriterQos& qos, std::size_t nodes) {
  qos.publish_mode().kind = eprosima::fastdds::dds::ASYNCHRONOUS_PUBLISH_MODE;
  qos.reliable_writer_qos().disable_heartbeat_piggyback = true;
  qos.reliable_writer_qos().times.heartbeatPeriod =
      eprosima::fastrtps::Duration_t(std::chrono::duration<double>(messages::status_period(nodes)).count());
}

}  // namespace

void fit_to_hub(DataWriterQos& qos, topics::TopicId topic, std::size_t nodes) {
  make_room_for_sources(qos);
  const bool is_replaced_by_the_next = topic == topics::TopicId::kNodeStatus || topic == topics::TopicId::kRegionMap;
  if (is_replaced_by_the_next) spare_the_hub(qos, nodes);
}

}  // namespace aurasim::dds
