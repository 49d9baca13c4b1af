// The tables of keys of generators, kind by kind.
#pragma once

#include "config/keys.h"

namespace aurasim::config {

enum class Anchor { kNone, kFirst, kLast, kBoth };

/// Keys that all formations have.
const KeyTable& formation_keys();

}  // namespace aurasim::config
