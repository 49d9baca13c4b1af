// Layer between Fast DDS and its sockets in every participant: a DatagramGuard for received datagrams and, if the
// network is impaired, a DelayLine for sent ones.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include "dds/delay_line.h"
#include "rtps/announcement_limit.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

class Introductions;

/// Parts that the transports of a participant share.
struct Wire {
  std::shared_ptr<rtps::DatagramGuard> guard;
  std::shared_ptr<DelayLine> line;  ///< null: the network is not impaired
  /// Shortest time between two of the participant's own announcements to one peer. 0: no limit.
  std::chrono::nanoseconds between_announcements{0};
  /// Hears the announcements that come in; null: this is no hub.
  std::shared_ptr<Introductions> introductions{};
};

struct WireTransportDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  /// `below` is the transport that sends and receives; with a delay line it must be UDPv4.
  WireTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below, Wire wire);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  /// True: every interface's socket sends; false: one socket sends unicast, and all send multicast.
  bool white_listed = false;
  Wire wire;
};

class WireTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit WireTransport(const WireTransportDescriptor& descriptor);
  ~WireTransport() override;

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  /// Sends through the delay line: only sent datagrams are impaired. Leaves out heartbeats and announcements that
  /// nobody needs.
  bool send(eprosima::fastrtps::rtps::SenderResource* socket, const eprosima::fastrtps::rtps::octet* bytes,
            std::uint32_t size, eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& time_out) override;
  /// Passes a received datagram through the guard. Sent datagrams are not filtered; the guard only takes note of
  /// them.
  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* receiver,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override;
  /// Sends all waiting datagrams. Fast DDS calls it before it closes the sockets.
  void shutdown() override;

 private:
  bool send_to(eprosima::fastrtps::rtps::SenderResource* socket, const eprosima::fastrtps::rtps::octet* bytes,
               std::uint32_t size, eprosima::fastrtps::rtps::LocatorsIterator* begin,
               eprosima::fastrtps::rtps::LocatorsIterator* end, const std::chrono::steady_clock::time_point& time_out);

  WireTransportDescriptor descriptor_;
  rtps::AnnouncementLimit announcements_;
  std::atomic<eprosima::fastrtps::rtps::SenderResource*> first_socket_{nullptr};
};

/// Ports on which a participant with this QoS and domain sends and receives discovery.
MetatrafficPorts metatraffic_ports(const eprosima::fastdds::dds::DomainParticipantQos& qos, std::uint32_t domain);

/// Puts the guard, and the delay line if there is one, over every transport of `qos`. Fast DDS's built-in transports,
/// shared memory among them, are not used. Throws DdsError when there is a line and a transport that is not UDPv4.
void install(eprosima::fastdds::dds::DomainParticipantQos& qos, const Wire& wire);

}  // namespace aurasim::dds
