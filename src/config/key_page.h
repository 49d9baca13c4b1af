// The tables of keys as people read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/keys.h"

namespace aurasim::config {

/// `root` and all tables that lead on from it, each once, in the order in which a reader meets them.
std::vector<const KeyTable*> tables_from(const KeyTable& root);

/// The part of docs/keys.md that scripts/write_keys.sh writes: every key of launch and scene files.
std::string keys_as_markdown();

/// For a terminal: all sections whose titles contain `part`; empty if there is none.
std::string keys_as_text(std::string_view part);

}  // namespace aurasim::config
