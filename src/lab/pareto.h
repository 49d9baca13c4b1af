// The pareto experiment: cost and error of each setup of the physics and the nodes.
#pragma once

#include <string>
#include <vector>

#include "lab/measured_run.h"
#include "lab/on_threads.h"
#include "lab/summary.h"

namespace aurasim::lab {

struct ParetoPlan {
  std::vector<int> iterations = {5, 10, 20, 50};
  std::vector<int> substeps = {1, 2, 4, 8};
  bool nodes = true;  ///< also vary the settings of nodes: their number, sync mode, lookahead, aura
};

/// One error of one case, as a metric of the results.
struct ParetoError {
  const char* name;
  const char* case_name;
  std::size_t metric;
};
const std::vector<ParetoError>& pareto_errors();

struct ParetoPoint {
  RunRules rules;
  int nodes = 1;
  std::string preset;          ///< names of the presets equal to this point, or empty
  std::vector<double> errors;  ///< in the order of pareto_errors()
  double error = 0;            ///< geometric mean of `errors`
  double cpu_us_per_step = 0;  ///< CPU time of the busiest node, summed over the cases
  bool same_bits = true;       ///< bits are as on one node with the same physics
  bool on_front = false;       ///< no other setup of the physics is both cheaper and better
};

/// Marks the points on the front: among those that vary the physics, no other point is both cheaper and better.
void mark_front(std::vector<ParetoPoint>& points);

std::vector<ParetoPoint> run_pareto(const ParetoPlan& plan, const Progress& progress);

std::vector<Target> pareto_targets(const std::vector<ParetoPoint>& points);

}  // namespace aurasim::lab
