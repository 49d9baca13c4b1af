// The tables of keys as JSON schema (draft 7), for editors.
#pragma once

#include <string>

#include "config/keys.h"

namespace aurasim::config {

/// Of a file whose top is `root`. Everything that the reader takes passes. What it refuses does not, but for what goes
/// beyond a key and its value: names that nobody has, minima above their maxima, boxes that overlap and the like.
std::string key_schema(const KeyTable& root);

}  // namespace aurasim::config
