#include "dds/wire_transport.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "dds/introductions.h"
#include "dds/settings.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::Locators;
using eprosima::fastdds::rtps::TransportDescriptorInterface;
using eprosima::fastdds::rtps::TransportReceiverInterface;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

namespace {

rtps::Peer peer_of(const SenderResource* socket, const Locator_t& destination) {
  rtps::Peer peer;
  peer.socket = reinterpret_cast<std::uintptr_t>(socket);  // NOLINT: an id
  std::copy_n(&destination.address[0], peer.address.size(), peer.address.begin());
  peer.port = destination.port;
  return peer;
}

rtps::Source source_of(const Locator_t& remote) {
  const octet* address = IPLocator::getIPv4(remote);
  rtps::Source source;
  for (int i = 0; i < 4; ++i) source.address = source.address << 8 | address[i];
  source.port = static_cast<std::uint16_t>(remote.port);
  return source;
}

}  // namespace

MetatrafficPorts metatraffic_ports(const DomainParticipantQos& qos, std::uint32_t domain) {
  const auto& port = qos.wire_protocol().port;
  const std::uint32_t first = port.portBase + port.domainIDGain * domain;
  MetatrafficPorts ports;
  ports.first_unicast = first + port.offsetd1;
  ports.stride = port.participantIDGain;
  ports.end = first + port.domainIDGain;
  for (const auto& server : qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers) {
    for (const Locator_t& locator : server.metatrafficUnicastLocatorList) ports.servers.push_back(locator.port);
  }
  return ports;
}

WireTransportDescriptor::WireTransportDescriptor(std::shared_ptr<TransportDescriptorInterface> below, Wire the_wire)
    : ChainingTransportDescriptor(below), wire(std::move(the_wire)) {
  const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(below);
  white_listed = udp != nullptr && !udp->interfaceWhiteList.empty();
}

eprosima::fastdds::rtps::TransportInterface* WireTransportDescriptor::create_transport() const {
  return new WireTransport(*this);  // NOLINT: Fast DDS takes it
}

WireTransport::WireTransport(const WireTransportDescriptor& descriptor)
    : ChainingTransport(descriptor), descriptor_(descriptor), announcements_(descriptor.wire.between_announcements) {}

WireTransport::~WireTransport() = default;

bool WireTransport::send(SenderResource* socket, const octet* bytes, std::uint32_t size, LocatorsIterator* begin,
                         LocatorsIterator* end, const std::chrono::steady_clock::time_point& time_out) {
  const std::span datagram(bytes, size);
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  rtps::DatagramGuard& guard = *descriptor_.wire.guard;
  guard.note_sent(datagram, now);
  const auto heartbeat = rtps::heartbeat_in(datagram);
  const auto announcement = announcements_.is_limited() ? rtps::announcement_in(datagram) : std::nullopt;
  if (!heartbeat && !announcement) return send_to(socket, bytes, size, begin, end, time_out);
  std::vector<Locator_t> due;
  for (; *begin != *end; ++*begin) {
    const rtps::Peer peer = peer_of(socket, **begin);
    const bool is_due =
        heartbeat ? guard.allows(*heartbeat, peer, now) : announcements_.allows(peer, *announcement, now);
    if (is_due) due.push_back(**begin);
  }
  if (due.empty()) return true;
  Locators first(due.cbegin()), last(due.cend());
  return send_to(socket, bytes, size, &first, &last, time_out);
}

bool WireTransport::send_to(SenderResource* socket, const octet* bytes, std::uint32_t size, LocatorsIterator* begin,
                            LocatorsIterator* end, const std::chrono::steady_clock::time_point& time_out) {
  if (descriptor_.wire.line == nullptr) return socket->send(bytes, size, begin, end, time_out);
  SenderResource* none = nullptr;
  const bool first = first_socket_.compare_exchange_strong(none, socket) || none == socket;
  bool sent = true;
  for (; *begin != *end; ++*begin) {
    const Locator_t& destination = **begin;
    if (!IsLocatorSupported(destination)) continue;
    // Fast DDS offers every datagram to every socket. Sockets after the first one do not send unicast.
    if (!first && !descriptor_.white_listed && !IPLocator::isMulticast(destination)) continue;
    sent &= descriptor_.wire.line->send(*socket, bytes, size, destination);
  }
  return sent;
}

void WireTransport::receive(TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size,
                            const Locator_t& local, const Locator_t& remote) {
  // The bytes are a buffer of the socket's thread, made for what it receives.
  const std::span datagram(const_cast<octet*>(bytes), size);  // NOLINT
  const auto& introductions = descriptor_.wire.introductions;
  const bool is_to_be_passed_on = introductions != nullptr && rtps::announcement_in(datagram).has_value();
  const auto admitted =
      descriptor_.wire.guard->admit(datagram, source_of(remote), std::chrono::steady_clock::now().time_since_epoch());
  if (is_to_be_passed_on && admitted.size > 0) introductions->hear(datagram);
  const auto delivery = descriptor_.wire.guard->delivery().begin(admitted.is_alone);
  for (const auto& made : admitted.before) {
    const auto whole = made.bytes();
    receiver->OnDataReceived(whole.data(), static_cast<std::uint32_t>(whole.size()), local, remote);
  }
  if (admitted.size > 0) {
    receiver->OnDataReceived(bytes, static_cast<std::uint32_t>(admitted.size), local, remote);
  }
}

void WireTransport::shutdown() {
  descriptor_.wire.guard->delivery()
      .open();  // else closing the sockets waits for their threads, which wait in the delivery
  if (descriptor_.wire.line != nullptr) descriptor_.wire.line->stop();
  low_level_transport_->shutdown();
}

void install(DomainParticipantQos& qos, const Wire& wire) {
  auto& transports = qos.transport().user_transports;
  if (transports.empty()) transports.push_back(std::make_shared<UDPv4TransportDescriptor>());
  qos.transport().use_builtin_transports = false;  // they would bypass it
  for (auto& transport : transports) {
    if (wire.line != nullptr && std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport) == nullptr) {
      throw DdsError("the network can be impaired (aurasim.impair.*, dds.impair) only where all transports are UDPv4");
    }
    transport = std::make_shared<WireTransportDescriptor>(transport, wire);
  }
}

}  // namespace aurasim::dds
