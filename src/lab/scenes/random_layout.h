// Random regions of a world, and the critical places where they meet.
#pragma once

#include <vector>

#include "lab/pair.h"
#include "lab/scenes/json.h"

namespace aurasim::lab {

struct RandomLayout {
  Json regions;                   ///< of the launch file
  std::vector<core::Vec3> spots;  ///< z = 0: corners at which regions meet; between columns, places on the border
  double half_x_m = 0, half_y_m = 0;
};

/// Columns, grid, brick, or boxes of uneven sizes: 2 to 9 regions, none narrower than `narrowest_m`.
RandomLayout random_layout(double narrowest_m, Chance& chance);

}  // namespace aurasim::lab
