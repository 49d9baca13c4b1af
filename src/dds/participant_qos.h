// The participant's QoS: its profile, with what the settings replace in it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "dds/profiles.h"
#include "dds/settings.h"

namespace aurasim::dds {

/// Returns the QoS. settings.interfaces, .discovery and .peers, where given, replace those of the profile. The largest
/// message is what fits into a packet of the links that carry it (link_mtu.h). Throws DdsError for an invalid value.
eprosima::fastdds::dds::DomainParticipantQos participant_qos(Profiles& profiles, const Settings& settings);

/// User data of a hub's participant.
inline constexpr std::string_view kHubUserData = "aurasim hub";

/// UDP port at which the hub of a run receives announcements (Discovery::kNeighbours). No participant of the domain has
/// this port by itself. A run with keys has another one, so that an open run beside it may have a hub, too.
std::uint16_t hub_port(const Settings& settings);

/// Address at which it does so.
std::string hub_address(const Settings& settings);

/// Largest datagram that all transports send, bytes, without the headers of IP and UDP.
std::uint32_t largest_datagram_B(const eprosima::fastdds::dds::DomainParticipantQos& qos);

/// Lets transports send the handshakes of keys, which Fast DDS 2.9.1 can send in one datagram only: certificate and
/// permissions have some kB. On a link with smaller packets IP fragments them.
void make_room_for_handshakes(eprosima::fastdds::dds::DomainParticipantQos& qos);

/// True when every transport may use loopback addresses only.
bool on_loopback_only(const eprosima::fastdds::dds::DomainParticipantQos& qos);

}  // namespace aurasim::dds
