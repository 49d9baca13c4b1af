// What holds for everybody in a run with keys, as the document that DDS-Security reads.
#pragma once

#include <string>

namespace aurasim::security {

/// XML. Nobody without keys joins or is heard, discovery is encrypted, and so is every message of every topic, with
/// what DDS says of it (heartbeats, acknowledgements); each endpoint has a key of its own, which only those get whom it
/// is matched with.
std::string governance_document();

}  // namespace aurasim::security
