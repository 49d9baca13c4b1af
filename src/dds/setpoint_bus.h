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
  /// Has a message of this program with this number, or a later one, come by the last take()? True also when the
  /// message was for another generation, or was dropped.
  bool has_heard(const core::ProgramWord& word) const;
  /// This node has computed a state: programs may say something for the next one.
  void note_state();
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
  /// The last message that was sent; number 0: none was.
  core::ProgramWord last_word() const;
  std::size_t listeners() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
