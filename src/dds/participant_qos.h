// The participant's QoS: its profile, with what the settings replace in it.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "dds/profiles.h"
#include "dds/settings.h"

namespace aurasim::dds {

/// Precedence: settings.interfaces, .discovery and .peers, where given, replace what the profile says. Throws DdsError
/// when a value cannot be used.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(Profiles& profiles, const Settings& settings);

}  // namespace aurasim::dds
