// Suites that run whole rains. They need the setup of a node as `aurasim launch` makes it.
#pragma once

#include <vector>

#include "lab/suites/suites.h"

namespace aurasim::lab::commands {

std::vector<Suite> rain_suites();

}  // namespace aurasim::lab::commands
