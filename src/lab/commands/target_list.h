// What an experiment has to show, as a table for people.
#pragma once

#include <vector>

#include "lab/summary.h"

namespace aurasim::lab::commands {

void print(const std::vector<lab::Target>& targets);
bool all_met(const std::vector<lab::Target>& targets);

}  // namespace aurasim::lab::commands
