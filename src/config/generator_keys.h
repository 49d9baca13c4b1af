// The tables of keys of generators, kind by kind.
#pragma once

#include "config/keys.h"

namespace aurasim::config {

enum class Anchor { kNone, kFirst, kLast, kBoth };

/// What all formations take.
const KeyTable& formation_keys();

}  // namespace aurasim::config
