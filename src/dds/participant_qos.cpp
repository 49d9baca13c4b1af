#include "dds/participant_qos.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

#include "dds/link_mtu.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

namespace {

constexpr std::uint16_t kDiscoveryServerPort = 11811;
constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kMulticastGroup = "239.255.0.1";  ///< of RTPS, for announcements
/// A part of a message has to fit into a datagram with all headers. On a link with smaller packets IP fragments.
constexpr std::uint32_t kSmallestDatagram_B = 1200;

/// Puts `interfaces` in place of every transport's white list. Copies the descriptors: the profile's are shared.
void set_interfaces(DomainParticipantQos& qos, const std::vector<std::string>& interfaces) {
  const bool all = std::ranges::find(interfaces, "*") != interfaces.end();
  auto& transports = qos.transport().user_transports;
  bool replaced = false;
  for (auto& transport : transports) {
    const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport);
    if (udp == nullptr) {
      throw DdsError("dds.interfaces can be given only with profiles whose transports are all UDPv4");
    }
    auto copy = std::make_shared<UDPv4TransportDescriptor>(*udp);
    copy->interfaceWhiteList = all ? std::vector<std::string>{} : interfaces;
    transport = copy;
    replaced = true;
  }
  if (!replaced) {
    auto udp = std::make_shared<UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = all ? std::vector<std::string>{} : interfaces;
    transports.push_back(udp);
  }
  qos.transport().use_builtin_transports = false;
}

/// Locator of a peer given as "address" or "address:port".
Locator_t locator_of(const std::string& peer, std::uint16_t default_port) {
  const auto colon = peer.find(':');
  const std::string address = peer.substr(0, colon);
  std::uint16_t port = default_port;
  if (colon != std::string::npos) {
    const char* last = peer.data() + peer.size();
    const auto [end, error] = std::from_chars(peer.data() + colon + 1, last, port);
    if (error != std::errc{} || end != last) {
      throw DdsError(fmt::format("dds.peers: '{}' is not \"address\" or \"address:port\"", peer));
    }
  }
  Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = port;
  if (!IPLocator::setIPv4(locator, address)) {
    throw DdsError(fmt::format("dds.peers: '{}' is not an IPv4 address", address));
  }
  return locator;
}

/// Makes the participant announce itself to the peers only. Naming an own locator for discovery switches multicast off.
void set_peers(DomainParticipantQos& qos, const Settings& settings) {
  auto& builtin = qos.wire_protocol().builtin;
  if (!settings.peers.empty()) {
    builtin.initialPeersList.clear();
    for (const auto& peer : settings.peers) {
      builtin.initialPeersList.push_back(locator_of(peer, 0));
    }
  }
  if (builtin.initialPeersList.empty()) {
    throw DdsError("dds.discovery is peers, but neither dds.peers nor the profile names a peer");
  }
  if (!settings.interfaces.empty() && settings.interfaces.front() != "*") {
    builtin.metatrafficUnicastLocatorList.clear();
    for (const auto& address : settings.interfaces) {
      builtin.metatrafficUnicastLocatorList.push_back(locator_of(address, 0));
    }
  }
  if (builtin.metatrafficUnicastLocatorList.empty()) {
    throw DdsError(
        "dds.discovery is peers, but no own address is known: name it in dds.interfaces or in the profile's "
        "metatrafficUnicastLocatorList");
  }
}

/// Own addresses, where others send announcements to at `port`; 0: the port of this participant.
void listen_at(eprosima::fastrtps::rtps::LocatorList_t& own, const std::vector<std::string>& addresses,
               std::uint16_t port) {
  own.clear();
  for (const std::string& address : addresses) own.push_back(locator_of(address, port));
}

/// Makes the hub listen where its site looks for it, and announce itself to the hubs of the other sites. On loopback it
/// is also on multicast: so it meets tools and clients that know nothing of hubs.
void set_own_hub(DomainParticipantQos& qos, const Settings& settings) {
  const std::string address = hub_address(settings);
  const std::uint16_t port = hub_port(settings);
  auto& builtin = qos.wire_protocol().builtin;
  std::vector<std::string> own = {address};
  std::ranges::copy_if(settings.interfaces, std::back_inserter(own), [&](const auto& one) { return one != address; });
  listen_at(builtin.metatrafficUnicastLocatorList, own, port);
  builtin.initialPeersList.push_back(locator_of(address, port));  // an empty list would mean multicast
  for (const std::string& peer : settings.peers) builtin.initialPeersList.push_back(locator_of(peer, port));
  qos.user_data().setValue({kHubUserData.begin(), kHubUserData.end()});
  if (!address.starts_with("127.")) return;
  Locator_t everybody;
  IPLocator::createLocator(LOCATOR_KIND_UDPv4, kMulticastGroup,
                           qos.wire_protocol().port.getMulticastPort(settings.domain), everybody);
  builtin.metatrafficMulticastLocatorList.push_back(everybody);
  builtin.initialPeersList.push_back(everybody);
}

/// Makes the participant announce itself to the hub of its site only.
void set_hub(DomainParticipantQos& qos, const Settings& settings) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.initialPeersList.clear();
  if (settings.introductions != nullptr) return set_own_hub(qos, settings);
  builtin.initialPeersList.push_back(locator_of(hub_address(settings), hub_port(settings)));
  const std::vector<std::string> loopback = {kLoopback};
  listen_at(builtin.metatrafficUnicastLocatorList, settings.interfaces.empty() ? loopback : settings.interfaces, 0);
}

/// Sets discovery by `fast-discovery-server -i N`, where N is the position in the list. As a super client the
/// participant discovers every endpoint.
void set_servers(DomainParticipantQos& qos, const Settings& settings) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.discoveryProtocol = eprosima::fastrtps::rtps::DiscoveryProtocol_t::SUPER_CLIENT;
  if (settings.peers.empty() && discovery.m_DiscoveryServers.empty()) {
    throw DdsError("dds.discovery is server, but neither dds.peers nor the profile names a server");
  }
  if (settings.peers.empty()) {
    return;
  }
  discovery.m_DiscoveryServers.clear();
  for (std::size_t i = 0; i < settings.peers.size(); ++i) {
    eprosima::fastdds::rtps::RemoteServerAttributes server;
    server.ReadguidPrefix(fmt::format("44.53.{:02x}.5f.45.50.52.4f.53.49.4d.41", i).c_str());
    server.metatrafficUnicastLocatorList.push_back(locator_of(settings.peers[i], kDiscoveryServerPort));
    discovery.m_DiscoveryServers.push_back(server);
  }
}

/// Keeps datagrams within a packet of the links, so that IP does not fragment them. Larger messages are sent in parts
/// (parts.h): a lost one is retransmitted alone. Copies the descriptors, because the profile's are shared.
void fit_to_links(DomainParticipantQos& qos) {
  const std::vector<Interface> interfaces = interfaces_of_this_host();
  for (auto& transport : qos.transport().user_transports) {
    const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport);
    if (udp == nullptr) continue;
    const std::uint32_t payload_B = largest_payload_B(interfaces, udp->interfaceWhiteList);
    const std::uint32_t largest_B = payload_B == 0 ? 0 : std::max(payload_B, kSmallestDatagram_B);
    if (largest_B == 0 || udp->maxMessageSize <= largest_B) continue;
    auto copy = std::make_shared<UDPv4TransportDescriptor>(*udp);
    copy->maxMessageSize = largest_B;
    transport = copy;
  }
}

/// Gives the participant the lowest free port. Fast DDS numbers the participants of a process and never reuses a
/// number, so a process that has joined DDS often would listen above the ports at which peers look for it.
void listen_where_peers_look(DomainParticipantQos& qos, std::uint32_t domain) {
  const auto& ports = qos.wire_protocol().port;
  for (Locator_t& own : qos.wire_protocol().builtin.metatrafficUnicastLocatorList) {
    if (own.port == 0) own.port = ports.getUnicastPort(domain, 0);
  }
}

/// Sets up DDS-Security with the plugins that come with Fast DDS.
void set_keys(DomainParticipantQos& qos, const security::KeyFiles& keys) {
  auto& properties = qos.properties().properties();
  const auto set = [&properties](const char* name, const std::string& value) { properties.emplace_back(name, value); };
  const auto set_file = [&set](const char* name, const std::filesystem::path& file) {
    set(name, "file://" + file.string());
  };
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set_file("dds.sec.auth.builtin.PKI-DH.identity_ca", keys.identity_ca);
  set_file("dds.sec.auth.builtin.PKI-DH.identity_certificate", keys.certificate);
  set_file("dds.sec.auth.builtin.PKI-DH.identity_crl", keys.revocations);
  set_file("dds.sec.auth.builtin.PKI-DH.private_key", keys.key);
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set_file("dds.sec.access.builtin.Access-Permissions.permissions_ca", keys.permissions_ca);
  set_file("dds.sec.access.builtin.Access-Permissions.governance", keys.governance);
  set_file("dds.sec.access.builtin.Access-Permissions.permissions", keys.permissions);
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

}  // namespace

DomainParticipantQos participant_qos(Profiles& profiles, const Settings& settings) {
  DomainParticipantQos qos = profiles.participant();
  if (!settings.interfaces.empty()) {
    set_interfaces(qos, settings.interfaces);
  }
  fit_to_links(qos);
  if (settings.discovery == config::Discovery::kPeers) {
    set_peers(qos, settings);
  } else if (settings.discovery == config::Discovery::kServer) {
    set_servers(qos, settings);
  } else if (settings.discovery == config::Discovery::kNeighbours) {
    set_hub(qos, settings);
  }
  listen_where_peers_look(qos, settings.domain);
  if (settings.keys) set_keys(qos, *settings.keys);
  return qos;
}

std::uint16_t hub_port(const Settings& settings) {
  // RTPS gives a domain 250 ports; the participants' begin at the 10th, after two for multicast.
  constexpr std::uint32_t kOfHub = 2, kOfHubWithKeys = 3;
  const eprosima::fastrtps::rtps::PortParameters ports;
  return static_cast<std::uint16_t>(ports.portBase + ports.domainIDGain * settings.domain +
                                    (settings.keys ? kOfHubWithKeys : kOfHub));
}

std::string hub_address(const Settings& settings) {
  if (!settings.hub.empty()) return settings.hub;
  return settings.interfaces.empty() ? kLoopback : settings.interfaces.front();
}

void make_room_for_handshakes(DomainParticipantQos& qos) {
  constexpr std::uint32_t kHandshake_B = 16U << 10;
  for (auto& transport : qos.transport().user_transports) {
    const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport);
    if (udp == nullptr || udp->maxMessageSize >= kHandshake_B) continue;
    auto copy = std::make_shared<UDPv4TransportDescriptor>(*udp);
    copy->maxMessageSize = kHandshake_B;
    transport = copy;
  }
}

std::uint32_t largest_datagram_B(const DomainParticipantQos& qos) {
  std::uint32_t smallest = eprosima::fastdds::rtps::s_maximumMessageSize;
  for (const auto& transport : qos.transport().user_transports) {
    smallest = std::min(smallest, transport->max_message_size());
  }
  return smallest;
}

bool on_loopback_only(const DomainParticipantQos& qos) {
  const auto is_loopback = [](const std::string& address) { return address.starts_with("127."); };
  const auto stays = [&](const auto& transport) {
    const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport);
    return udp != nullptr && !udp->interfaceWhiteList.empty() &&
           std::ranges::all_of(udp->interfaceWhiteList, is_loopback);
  };
  const auto& transports = qos.transport().user_transports;
  return !qos.transport().use_builtin_transports && !transports.empty() && std::ranges::all_of(transports, stays);
}

}  // namespace aurasim::dds
