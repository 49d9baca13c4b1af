// Converts messages to the bytes that Fast DDS puts into a sample, and back. For measuring them, and for runs without
// DDS that are to pay the cost of coding.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "messages/codec.h"
#include "messages/command_codec.h"
#include "messages/setpoint_codec.h"

namespace aurasim::messages {

/// CDR with its four bytes of encapsulation, as in the payload of an RTPS DATA submessage. Keep one per thread: it
/// reuses its memory.
class WireBytes {
 public:
  WireBytes();
  ~WireBytes();

  std::vector<std::uint8_t> of(const core::AuraBatch& batch);
  std::vector<std::uint8_t> of(const core::HandOff& hand_off);
  std::vector<std::uint8_t> of(const NamedMesh& mesh);
  std::vector<std::uint8_t> of(const core::Setpoints& setpoints);

  Decoded<core::AuraBatch> aura(std::span<const std::uint8_t> bytes, const Expected& expected);
  Decoded<core::HandOff> hand_off(std::span<const std::uint8_t> bytes, const Expected& expected);
  Decoded<NamedMesh> mesh(std::span<const std::uint8_t> bytes);
  Decoded<core::Setpoints> setpoints(std::span<const std::uint8_t> bytes);

 private:
  struct Samples;
  std::unique_ptr<Samples> samples_;
};

}  // namespace aurasim::messages
