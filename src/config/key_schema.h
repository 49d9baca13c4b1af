// The tables of keys as JSON schema (draft 7), for editors.
#pragma once

#include <string>

#include "config/keys.h"

namespace aurasim::config {

/// Returns the schema of a file whose top is `root`. Every file that the reader accepts is valid. A file that it
/// refuses is invalid, unless the error goes beyond a key and its value: unknown names, minima above maxima, boxes that
/// overlap and the like.
std::string key_schema(const KeyTable& root);

}  // namespace aurasim::config
