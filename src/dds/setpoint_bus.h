// Topic control: setpoints that programs publish for bodies and joints (core/setpoint.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/setpoint.h"
#include "dds/participant.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

/// A node's endpoint. Used by one thread. The participant must outlive it.
class SetpointReader {
 public:
  explicit SetpointReader(Participant& participant);
  ~SetpointReader();

  /// Returns setpoints for this generation that arrived since the last call, in order of arrival.
  std::vector<core::Setpoints> take(core::Generation generation);
  /// True when the last take() or an earlier one received a message of this program with this number or a later one.
  /// True also when the message was for another generation or was dropped.
  bool has_received(const core::ProgramWord& word) const;
  /// To be called when this node has computed a state: it allows each program one more message.
  void note_state();
  /// Number of messages dropped because their sender sent far more than a state needs, or because they were invalid.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A program's endpoint. Used by one thread. The participant must outlive it.
class SetpointWriter {
 public:
  explicit SetpointWriter(Participant& participant);
  ~SetpointWriter();

  /// Publishes setpoints; fills in their number and sender. Throws DdsError when the
  /// write failed.
  void send(core::Setpoints setpoints);
  /// The last message that was sent; number 0: none was.
  core::ProgramWord last_word() const;
  std::size_t listeners() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
