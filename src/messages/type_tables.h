// The type tables of Fast DDS, which all of a process shares.
#pragma once

namespace aurasim::messages {

/// Fills Fast DDS's type tables with our types; further calls do nothing. Call it before a thread may use a message
/// type: Fast DDS 2.9.1 fills these tables without a lock when the first message is made or the first peer discovered,
/// and a process that does either on two threads at once crashes (1 in 6 starts of an experiment on two threads).
void set_type_tables_up();

}  // namespace aurasim::messages
