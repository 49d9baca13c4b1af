// Sizes of messages on the wire, by their contents.
#pragma once

#include <vector>

#include "lab/suites/result_row.h"

namespace aurasim::lab {

/// Bytes of serialised payloads. The size of an element, such as one aura update, is the difference between two
/// messages with different numbers of it.
std::vector<ResultRow> message_sizes();

}  // namespace aurasim::lab
