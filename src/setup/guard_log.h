// Log messages about datagrams that were refused before Fast DDS could read them.
#pragma once

#include "dds/participant.h"

namespace aurasim::setup {

/// Logs one warning for each address from which a datagram was refused for the first time.
void log_new_refusals(dds::Participant& participant);
/// Logs all refusals at the end of the process. Logs nothing if there were none.
void log_refusals(dds::Participant& participant);

}  // namespace aurasim::setup
