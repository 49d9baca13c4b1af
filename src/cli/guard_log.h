// What a process's log says of datagrams that were kept from Fast DDS.
#pragma once

#include "dds/participant.h"

namespace aurasim::cli {

/// One warning for each address of which something was refused for the first time.
void log_new_refusals(dds::Participant& participant);
/// All of them, at the end; nothing if there were none.
void log_refusals(dds::Participant& participant);

}  // namespace aurasim::cli
