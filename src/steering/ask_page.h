// The table of asks as people and editors read it.
#pragma once

#include <string>

namespace aurasim::steering {

/// The part of docs/commands.md that scripts/write_keys.sh writes: every kind of ask with its fields.
std::string asks_as_markdown();
/// A JSON schema of one ask: docs/aurasim-asks.schema.json.
std::string ask_schema();

}  // namespace aurasim::steering
