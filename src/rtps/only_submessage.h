// What a datagram says, if it says one thing. Fast DDS puts a time and a destination before it; eProsima's statistics
// end each datagram of a Fast DDS that is built with them, as Debian's is. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

struct Submessage {
  std::uint8_t kind = 0, flags = 0;
  WireCursor body;  ///< reads what follows the submessage's header
};

/// The only submessage of a datagram besides times, destinations and statistics. Nothing: it has none or several, or
/// one does not fit.
std::optional<Submessage> only_submessage(std::span<const std::uint8_t> datagram);

}  // namespace aurasim::rtps
