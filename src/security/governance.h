// The rules for all participants of a run with keys, as the document that DDS-Security reads.
#pragma once

#include <string>

namespace aurasim::security {

/// Returns the governance document, XML. No participant without keys may join or is accepted. Discovery is encrypted,
/// and so is every message of every topic, with its heartbeats and acknowledgements. Each endpoint has a key of its
/// own, which only the endpoints matched with it get.
std::string governance_document();

}  // namespace aurasim::security
