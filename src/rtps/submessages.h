// The submessages of a datagram, one after the other, and the only one, if it says one thing. Fast DDS puts a time and
// a destination before it; eProsima's statistics end each datagram of a Fast DDS that is built with them, as Debian's
// is. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

inline constexpr std::size_t kSubmessageHeader_B = 4;
inline constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e;

struct Submessage {
  std::uint8_t kind = 0, flags = 0;
  std::size_t size_B = 0;  ///< as its header has it; 0: it goes to the end of the datagram, if it is no time
  WireCursor body;         ///< reads what follows the submessage's header
};

/// Reads a datagram from behind its header.
WireCursor submessages_of(std::span<const std::uint8_t> datagram);
/// Takes the next submessage. Precondition: at least kSubmessageHeader_B are left. `rest` has failed if it does not
/// fit.
Submessage take_submessage(WireCursor& rest);

/// The only submessage of a datagram besides times, destinations and statistics. Nothing: it has none or several, or
/// one does not fit.
std::optional<Submessage> only_submessage(std::span<const std::uint8_t> datagram);

}  // namespace aurasim::rtps
