#include "rtps/source_limits.h"

namespace aurasim::rtps {

SourceLimits::Address& SourceLimits::address_of(std::uint32_t address, Time now) {
  return addresses_.find(address, kMostAddresses, [&] {
    return Address{{limits_.address_datagrams_per_s, limits_.address_datagrams_burst, now},
                   {limits_.jumps_per_s, limits_.jumps_burst, now},
                   {limits_.gaps_per_s, limits_.gaps_burst, now}};
  });
}

bool SourceLimits::take_datagram(Source source, std::size_t bytes, Time now) {
  const std::uint64_t key = std::uint64_t{source.address} << 16 | source.port;
  Socket& socket = sockets_.find(key, kMostSockets, [&] {
    return Socket{{limits_.datagrams_per_s, limits_.datagrams_burst, now},
                  {limits_.bytes_per_s, limits_.bytes_burst, now}};
  });
  return socket.datagrams.take(1, now) && socket.bytes.take(static_cast<double>(bytes), now) &&
         address_of(source.address, now).datagrams.take(1, now);
}

}  // namespace aurasim::rtps
