// Topic control: what programs want of bodies and joints (core/setpoint.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/setpoint.h"
#include "dds/participant.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

/// Of a node. Used by one thread. The participant must outlive it.
class SetpointReader {
 public:
  explicit SetpointReader(Participant& participant);
  ~SetpointReader();

  /// Those for this generation that have come since the last call, in order of arrival.
  std::vector<core::Setpoints> take(core::Generation generation);
  /// Messages that were dropped: their sender has sent far more than a state needs, or what is none.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Of a program. Used by one thread. The participant must outlive it.
class SetpointWriter {
 public:
  explicit SetpointWriter(Participant& participant);
  ~SetpointWriter();

  /// Numbers them, and says who sends them; large ones go in several messages. Throws DdsError when the write failed.
  void send(core::Setpoints setpoints);
  /// All nodes that were there when they were sent have them.
  bool is_known();
  std::size_t listeners() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
