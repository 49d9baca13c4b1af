// UDPv4 with a DelayLine before it. Installed only where something is impaired.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include "dds/delay_line.h"

namespace aurasim::dds {

struct ImpairedTransportDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  ImpairedTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::UDPv4TransportDescriptor> udp,
                              std::shared_ptr<DelayLine> line);
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override;

  bool white_listed;  ///< then every interface's socket sends; if not, one for unicast and all for multicast
  std::shared_ptr<DelayLine> line;
};

class ImpairedTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  explicit ImpairedTransport(const ImpairedTransportDescriptor& descriptor);
  ~ImpairedTransport() override;

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }
  bool send(eprosima::fastrtps::rtps::SenderResource* socket, const eprosima::fastrtps::rtps::octet* bytes,
            std::uint32_t size, eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& time_out) override;
  /// Only what is sent is impaired.
  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* receiver,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override;
  /// Comes before the sockets are closed: what waits is sent now.
  void shutdown() override;

 private:
  ImpairedTransportDescriptor descriptor_;
  std::atomic<eprosima::fastrtps::rtps::SenderResource*> first_socket_{nullptr};
};

/// Puts one delay line under every transport. Throws DdsError when one of them is not UDPv4.
std::shared_ptr<DelayLine> impair(eprosima::fastdds::dds::DomainParticipantQos& qos, const Impairment& impairment,
                                  std::uint32_t domain, std::uint64_t stream);

}  // namespace aurasim::dds
