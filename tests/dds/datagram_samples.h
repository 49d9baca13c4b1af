// RTPS datagrams, put together by hand.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "rtps/datagram_findings.h"

namespace aurasim::dds::testing {

using Bytes = std::vector<std::uint8_t>;

inline constexpr rtps::GuidPrefix kPrefix = {1, 15, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
inline constexpr std::uint32_t kWriter = 0x00000203, kReader = 0x00000204;
inline constexpr std::uint32_t kEndpointWriter = 0x000003c2;
inline constexpr std::uint32_t kHandshakeWriter = 0x000201c3;

/// Octets, one behind the other; numbers are little-endian.
class Octets {
 public:
  Octets& raw(std::initializer_list<std::uint8_t> octets) {
    bytes_.insert(bytes_.end(), octets);
    return *this;
  }
  Octets& raw(const Bytes& bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  Octets& zeros(std::size_t count) {
    bytes_.resize(bytes_.size() + count);
    return *this;
  }
  Octets& u16(std::uint64_t number) { return number_of(number, 2); }
  Octets& u32(std::uint64_t number) { return number_of(number, 4); }
  Octets& sequence(std::uint64_t number) { return u32(number >> 32).u32(number); }
  Octets& entity(std::uint32_t id) {
    for (int i = 3; i >= 0; --i) bytes_.push_back(static_cast<std::uint8_t>(id >> 8 * i));
    return *this;
  }
  Octets& guid(const rtps::GuidPrefix& prefix, std::uint32_t id) {
    bytes_.insert(bytes_.end(), prefix.begin(), prefix.end());
    return entity(id);
  }
  Octets& text(std::string_view text) {
    u32(text.size() + 1);
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return zeros((4 - bytes_.size() % 4) % 4);
  }
  Octets& parameter(std::uint16_t pid, const Octets& value) {
    u16(pid).u16(value.bytes_.size());
    return raw(value.bytes_);
  }
  Octets& sentinel() { return u16(1).u16(0); }
  const Bytes& bytes() const { return bytes_; }

 private:
  Octets& number_of(std::uint64_t number, int octets) {
    for (int i = 0; i < octets; ++i) bytes_.push_back(static_cast<std::uint8_t>(number >> 8 * i));
    return *this;
  }
  Bytes bytes_;
};

inline Octets header(const rtps::GuidPrefix& prefix = kPrefix) {
  Octets octets;
  octets.raw({'R', 'T', 'P', 'S', 2, 3, 1, 15});
  for (const std::uint8_t octet : prefix) octets.raw({octet});
  return octets;
}

/// A submessage of little-endian numbers; bit 0 of `flags` says so.
inline Octets submessage(std::uint8_t id, std::uint8_t flags, const Octets& body) {
  Octets octets;
  octets.raw({id, static_cast<std::uint8_t>(flags | 1)}).u16(body.bytes().size()).raw(body.bytes());
  return octets;
}

/// eProsima's, which end a datagram.
inline Octets statistics() { return submessage(0x80, 0, Octets().zeros(56)); }

inline Octets bits(std::uint32_t count) { return Octets().u32(count).zeros((count + 31) / 32 * 4); }

inline Octets heartbeat(std::uint64_t first, std::uint64_t last, std::uint32_t writer = kWriter) {
  return submessage(0x07, 0, Octets().entity(kReader).entity(writer).sequence(first).sequence(last).u32(1));
}

inline Octets gap(std::uint64_t first, std::uint64_t base, std::uint32_t count = 0) {
  return submessage(0x08, 0,
                    Octets().entity(kReader).entity(kWriter).sequence(first).sequence(base).raw(bits(count).bytes()));
}

/// Of a reader: it has all before `base`, and would like to have the next `wanted`.
inline Octets ack_nack(std::uint64_t base, std::uint32_t wanted, std::uint32_t writer = kWriter) {
  Octets body;
  body.entity(kReader).entity(writer).sequence(base).u32(wanted);
  for (std::uint32_t left = wanted; left > 0; left -= left < 32 ? left : 32) {
    body.u32(left < 32 ? ~(~0U >> left) : ~0U);
  }
  return submessage(0x06, 0, body.u32(1));
}

/// Of fragments 1 to 8.
inline Octets nack_fragments(std::uint64_t sequence, std::uint32_t writer = kEndpointWriter) {
  return submessage(0x12, 0,
                    Octets().entity(kReader).entity(writer).sequence(sequence).u32(1).u32(8).u32(0xff00'0000).u32(1));
}

inline Octets data(std::uint32_t writer, std::uint64_t sequence, const Bytes& payload, const Bytes& inline_qos = {}) {
  const std::uint8_t flags = inline_qos.empty() ? 4 : 6;
  return submessage(0x15, flags,
                    Octets().u16(0).u16(16).entity(0).entity(writer).sequence(sequence).raw(inline_qos).raw(payload));
}

struct Fragment {
  std::uint32_t writer = kEndpointWriter;
  std::uint64_t sequence = 1;
  std::uint32_t first = 1;
  std::uint16_t count = 1;
  std::uint16_t fragment_B = 1024;
  std::uint32_t sample_B = 3000;
  std::size_t payload_B = 1024;
};

inline Octets fragment(const Fragment& f, const Bytes& payload = {}, const Bytes& inline_qos = {}) {
  Octets body;
  body.u16(0).u16(28).entity(0).entity(f.writer).sequence(f.sequence).u32(f.first).u16(f.count).u16(f.fragment_B);
  body.u32(f.sample_B).raw(inline_qos);
  if (payload.empty()) {
    body.zeros(f.payload_B);
  } else {
    body.raw(payload);
  }
  return submessage(0x16, inline_qos.empty() ? 0 : 2, body);
}

inline Bytes datagram(std::initializer_list<Octets> submessages) {
  Octets all = header();
  for (const Octets& submessage : submessages) all.raw(submessage.bytes());
  return all.bytes();
}

inline Octets to_all(const Octets& parameters) { return Octets().raw({0, 3, 0, 0}).raw(parameters.bytes()); }

inline Octets lease(std::uint32_t seconds) { return Octets().u32(seconds).u32(0); }

/// What a participant announces: its id, its lease and what else is said.
inline Octets participant(const rtps::GuidPrefix& prefix, const Octets& more = {}, std::uint32_t lease_s = 5) {
  return to_all(Octets()
                    .parameter(0x50, Octets().guid(prefix, 0x1c1))
                    .parameter(0x02, lease(lease_s))
                    .raw(more.bytes())
                    .sentinel());
}

inline Octets endpoint(const rtps::GuidPrefix& prefix, std::uint32_t entity, const Octets& more = {}) {
  return to_all(Octets()
                    .parameter(0x5a, Octets().guid(prefix, entity))
                    .parameter(0x05, Octets().text("aura"))
                    .parameter(0x07, Octets().text("aurasim::wire::AuraBatch"))
                    .raw(more.bytes())
                    .sentinel());
}

/// `writer` takes back what it has announced of `entity`: it is gone, and nothing of it is kept.
inline Octets farewell(std::uint32_t writer, const rtps::GuidPrefix& prefix, std::uint32_t entity) {
  return submessage(0x15, 2,
                    Octets()
                        .u16(0)
                        .u16(16)
                        .entity(0)
                        .entity(writer)
                        .sequence(2)
                        .parameter(0x70, Octets().guid(prefix, entity))
                        .parameter(0x71, Octets().raw({0, 0, 0, 3}))
                        .sentinel());
}

}  // namespace aurasim::dds::testing
