// The tables of keys of injectors.
#pragma once

#include "config/keys_of.h"
#include "core/scene.h"

namespace aurasim::config {

const KeysOf<core::Injector>& keys_of_injector();
const KeyTable& per_keys();

}  // namespace aurasim::config
