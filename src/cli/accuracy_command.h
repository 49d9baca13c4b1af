// `aurasim experiment stability` and `pareto`.
#pragma once

#include "cli/commands.h"

namespace aurasim::cli {

void add_stability(CLI::App& experiments, Action& action);
void add_pareto(CLI::App& experiments, Action& action);

}  // namespace aurasim::cli
