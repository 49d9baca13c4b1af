#include "dds/impaired_transport.h"

#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>

#include "dds/settings.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::TransportReceiverInterface;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using eprosima::fastrtps::rtps::LocatorsIterator;
using eprosima::fastrtps::rtps::octet;
using eprosima::fastrtps::rtps::SenderResource;

namespace {

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

}  // namespace

ImpairedTransportDescriptor::ImpairedTransportDescriptor(std::shared_ptr<UDPv4TransportDescriptor> udp,
                                                         std::shared_ptr<DelayLine> the_line)
    : ChainingTransportDescriptor(udp), white_listed(!udp->interfaceWhiteList.empty()), line(std::move(the_line)) {}

eprosima::fastdds::rtps::TransportInterface* ImpairedTransportDescriptor::create_transport() const {
  return new ImpairedTransport(*this);  // NOLINT: Fast DDS takes it
}

ImpairedTransport::ImpairedTransport(const ImpairedTransportDescriptor& descriptor)
    : ChainingTransport(descriptor), descriptor_(descriptor) {}

ImpairedTransport::~ImpairedTransport() = default;

bool ImpairedTransport::send(SenderResource* socket, const octet* bytes, std::uint32_t size, LocatorsIterator* begin,
                             LocatorsIterator* end, const std::chrono::steady_clock::time_point&) {
  SenderResource* none = nullptr;
  const bool first = first_socket_.compare_exchange_strong(none, socket) || none == socket;
  bool sent = true;
  for (; *begin != *end; ++*begin) {
    const Locator_t& destination = **begin;
    if (!IsLocatorSupported(destination)) continue;
    // Fast DDS offers every datagram to every socket, and those after the first keep unicast to themselves.
    if (!first && !descriptor_.white_listed && !IPLocator::isMulticast(destination)) continue;
    sent &= descriptor_.line->send(*socket, bytes, size, destination);
  }
  return sent;
}

void ImpairedTransport::receive(TransportReceiverInterface* receiver, const octet* bytes, std::uint32_t size,
                                const Locator_t& local, const Locator_t& remote) {
  receiver->OnDataReceived(bytes, size, local, remote);
}

void ImpairedTransport::shutdown() {
  descriptor_.line->stop();
  low_level_transport_->shutdown();
}

std::shared_ptr<DelayLine> impair(DomainParticipantQos& qos, const Impairment& impairment, std::uint32_t domain,
                                  std::uint64_t stream) {
  auto& transports = qos.transport().user_transports;
  if (transports.empty()) transports.push_back(std::make_shared<UDPv4TransportDescriptor>());
  qos.transport().use_builtin_transports = false;  // shared memory would bypass it
  const auto line = std::make_shared<DelayLine>(impairment, stream, metatraffic_ports(qos, domain));
  for (auto& transport : transports) {
    const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport);
    if (udp == nullptr) {
      throw DdsError("the network can be impaired (aurasim.impair.*, dds.impair) only where all transports are UDPv4");
    }
    transport = std::make_shared<ImpairedTransportDescriptor>(udp, line);
  }
  return line;
}

}  // namespace aurasim::dds
