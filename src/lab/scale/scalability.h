// The scalability experiment (thesis section 5.1): lists its runs and runs them on a few threads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/on_threads.h"
#include "lab/scale/rain.h"
#include "lab/scale/rain_run.h"

namespace aurasim::lab {

/// Names of series, in the order in which they are run:
///   columns      the thesis's: 1 to 10 columns of 80 m, the rain follows them
///   corners      3 regions around a point, grids of 4 and 9
///   cuts         one world of 8 columns, cut into 1, 2, 4 and 8
///   weak         as many bodies per node, 1 to 8 nodes
///   border       0 to 100% of the bodies near the border of two nodes
///   asleep       the rain stops half way
///   uncertainty  U from 0 to 2
///   lookahead    K of 1 and 2
std::vector<std::string> scalability_series();
/// Names of series of the bandwidth experiment. Every body falls near the border of two columns:
///   speed  top speed at birth from 2.5 to 15 m/s along each axis
///   link   each node's link from 12.5 MB/s (100 Mbit/s) down to 50 kB/s
std::vector<std::string> bandwidth_series();

struct ScalabilityPlan {
  std::vector<std::string> series = scalability_series();
  std::vector<std::string> auras = {"swept", "tight", "thesis"};
  std::vector<std::size_t> columns = {1, 2, 4, 8, 10};
  std::uint32_t repeats = 1;
  double run_s = 60;
  int lookahead = 0;  ///< K of runs with several nodes, except series "lookahead"; 0: from the tolerances
};

std::vector<Rain> rains_of(const ScalabilityPlan& plan);

/// The windows of each rain. Nothing if `progress` ended it early.
std::optional<std::vector<std::vector<Window>>> run_rains(const std::vector<Rain>& rains, const RainPlace& place,
                                                          int threads, const Progress& progress);

}  // namespace aurasim::lab
