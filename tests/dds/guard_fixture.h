// A DatagramGuard, and what it lets through.
#pragma once

#include <chrono>

#include <gtest/gtest.h>

#include "datagram_samples.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds::testing {

inline constexpr rtps::Source kSource{0x7f000001, 40'000};

inline rtps::GuidPrefix prefix_of(std::uint32_t number) {
  rtps::GuidPrefix prefix = kPrefix;
  for (int i = 0; i < 4; ++i) prefix[i] = static_cast<std::uint8_t>(number >> 8 * i);
  return prefix;
}

inline Bytes octets_of(const rtps::MadeDatagram& made) {
  const auto octets = made.bytes();
  return {octets.begin(), octets.end()};
}

class Guard : public ::testing::Test {
 protected:
  bool passes(Bytes bytes, rtps::Source source = kSource) { return guard_.admit(bytes, source, now_).size > 0; }
  bool passes(const Octets& submessage) { return passes(datagram({submessage})); }
  void meet() {
    ASSERT_TRUE(passes(data(rtps::kParticipantWriter, 1, participant(kPrefix).bytes())));
    ASSERT_TRUE(passes(data(kEndpointWriter, 1, endpoint(kPrefix, kWriter).bytes())));
  }
  std::uint64_t refused(rtps::Refusal why) const { return guard_.report().refused[static_cast<std::size_t>(why)]; }

  rtps::DatagramGuard guard_;
  rtps::DatagramGuard::Time now_ = std::chrono::hours(1);
};

}  // namespace aurasim::dds::testing
