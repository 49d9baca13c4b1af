// The pareto experiment: what each way to set up the physics and the nodes costs, and how wrong it is.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/measured_run.h"
#include "lab/summary.h"

namespace aurasim::lab {

struct ParetoPlan {
  double simulated_s = 3;
  std::vector<int> iterations = {5, 10, 20, 50};
  std::vector<int> substeps = {1, 2, 4, 8};
  std::vector<int> friction_directions = {1, 2};
  bool nodes = true;  ///< also vary what is about the nodes: their number, sync mode, lookahead, aura
};

/// One error of one case, as a column of pareto.csv.
struct ParetoError {
  const char* name;
  const char* case_name;
  std::size_t metric;
};
const std::vector<ParetoError>& pareto_errors();

struct ParetoPoint {
  RunRules rules;
  int nodes = 1;
  std::string preset;          ///< the presets that it is, or empty
  std::vector<double> errors;  ///< as pareto_errors()
  double error = 0;            ///< their geometric mean
  double cpu_us_per_step = 0;  ///< of the busiest node, summed over the cases
  bool same_bits = true;       ///< as one node with the same physics
  bool on_front = false;       ///< no other way to set up the physics is cheaper and better
};

/// Points that nothing else is both cheaper and better than, among those that vary the physics.
void mark_front(std::vector<ParetoPoint>& points);

/// As StabilityProgress.
using ParetoProgress = std::function<bool(double share)>;
std::vector<ParetoPoint> run_pareto(const ParetoPlan& plan, const ParetoProgress& progress);

/// pareto.csv and summary.json; returns what has to hold.
std::vector<Target> write_pareto(const std::vector<ParetoPoint>& points, const ParetoPlan& plan,
                                 const std::filesystem::path& directory);

}  // namespace aurasim::lab
