// The tables of keys of a launch file, section by section.
#pragma once

#include "config/keys_of.h"
#include "config/launch.h"

namespace aurasim::config {

const KeysOf<Launch>& launch_keys();
/// Keys of `regions` beside a layout.
const KeyTable& regions_keys();
const KeysOf<Time>& time_keys();
const KeysOf<Tolerances>& tolerances_keys();
const KeysOf<Aura>& aura_keys();
const KeysOf<Physics>& physics_keys();
const KeysOf<Dds>& dds_keys();
const KeysOf<Impair>& impair_keys();
const KeysOf<Observe>& observe_keys();
const KeysOf<Control>& control_keys();
const KeysOf<Ros2>& ros2_keys();
const KeysOf<Survival>& survival_keys();
const KeysOf<Overseer>& overseer_keys();
const KeyTable& tls_keys();

}  // namespace aurasim::config
