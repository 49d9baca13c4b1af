// QoS of a hub's writers, where it differs from that of other processes (hub.h).
#pragma once

#include <cstddef>

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>

#include "topics/topics.h"

namespace aurasim::dds {

/// Fits the QoS of a hub's writer to samples of many sources, in a run of `nodes` nodes.
void fit_to_hub(eprosima::fastdds::dds::DataWriterQos& qos, topics::TopicId topic, std::size_t nodes);

}  // namespace aurasim::dds
