// What an experiment has to show, as a table for people.
#pragma once

#include <vector>

#include "experiment/summary.h"

namespace aurasim::cli {

void print(const std::vector<experiment::Target>& targets);
bool all_met(const std::vector<experiment::Target>& targets);

}  // namespace aurasim::cli
