// What stands between Fast DDS and its sockets, in every participant: a DatagramGuard for what comes and, where the
// network is impaired, a DelayLine for what goes.
#pragma once

#include <atomic>
#include <memory>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include "dds/datagram_guard.h"
#include "dds/delay_line.h"

namespace aurasim::dds {

struct WireTransportDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  /// `below` is what sends and receives. `line` may be null; if it is not, `below` must be UDPv4.
  WireTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below,
                          std::shared_ptr<DatagramGuard> guard, std::shared_ptr<DelayLine> line);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  bool white_listed = false;  ///< then every interface's socket sends; if not, one for unicast and all for multicast
  std::shared_ptr<DatagramGuard> guard;
  std::shared_ptr<DelayLine> line;
};

class WireTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit WireTransport(const WireTransportDescriptor& descriptor);
  ~WireTransport() override;

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  /// Only what is sent is impaired.
  bool send(eprosima::fastrtps::rtps::SenderResource* socket, const eprosima::fastrtps::rtps::octet* bytes,
            std::uint32_t size, eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& time_out) override;
  /// Only what is received is guarded; of what is sent the guard takes note, and asks for fragments.
  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* receiver,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override;
  /// Comes before the sockets are closed: what waits is sent now.
  void shutdown() override;

 private:
  WireTransportDescriptor descriptor_;
  std::atomic<eprosima::fastrtps::rtps::SenderResource*> first_socket_{nullptr};
};

/// Where a participant of these profiles and of this domain hears and tells of others.
MetatrafficPorts metatraffic_ports(const eprosima::fastdds::dds::DomainParticipantQos& qos, std::uint32_t domain);

/// Puts the guard, and the line if there is one, over every transport; Fast DDS's built-in ones, shared memory among
/// them, are not used. Throws DdsError when there is a line and a transport that is not UDPv4.
void install(eprosima::fastdds::dds::DomainParticipantQos& qos, const std::shared_ptr<DatagramGuard>& guard,
             const std::shared_ptr<DelayLine>& line);

}  // namespace aurasim::dds
