#include "config/presets.h"

#include <stdexcept>

namespace aurasim::config {

const Preset& preset_named(const std::string& name) {
  for (const Preset& preset : kPresets) {
    if (preset.name == name) return preset;
  }
  throw std::invalid_argument("there is no preset \"" + name + "\"");
}

}  // namespace aurasim::config
