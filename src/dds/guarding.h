// Reports what a participant's guard (datagram_guard.h) has kept from Fast DDS. Callable from any thread.
#pragma once

#include <vector>

#include "dds/participant.h"
#include "rtps/guard_report.h"

namespace aurasim::dds {

rtps::GuardReport guarded(Participant& participant);
/// Addresses from which something was refused for the first time since the last call.
std::vector<rtps::GuardReport::Address> take_new_refusals(Participant& participant);

}  // namespace aurasim::dds
