#include "dds/source_limits.h"

#include <utility>

namespace aurasim::dds {

template <class Key, class Value>
template <class Make>
Value& SourceLimits::Recent<Key, Value>::find(const Key& key, std::size_t most, Make make) {
  if (const auto it = young.find(key); it != young.end()) return it->second;
  if (young.size() >= most / 2) {
    old = std::move(young);
    young.clear();
  }
  if (const auto it = old.find(key); it != old.end()) {
    Value value = it->second;
    old.erase(it);
    return young.emplace(key, value).first->second;
  }
  return young.emplace(key, make()).first->second;
}

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

}  // namespace aurasim::dds
