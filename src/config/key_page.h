// The tables of keys as people read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/keys.h"

namespace aurasim::config {

/// Returns `root` and all tables that can be reached from it, each once, in the order in which a reader meets them.
std::vector<const KeyTable*> tables_from(const KeyTable& root);

/// Returns the part of docs/keys.md that scripts/write_keys.sh writes: every key of launch and scene files.
std::string keys_as_markdown();

/// Returns, for a terminal, all sections whose titles contain `part`; empty if there is none.
std::string keys_as_text(std::string_view part);

}  // namespace aurasim::config
