// The requirements of an experiment, as a table for users.
#pragma once

#include <vector>

#include "lab/summary.h"

namespace aurasim::lab::commands {

void print(const std::vector<lab::Target>& targets);
bool all_met(const std::vector<lab::Target>& targets);

}  // namespace aurasim::lab::commands
