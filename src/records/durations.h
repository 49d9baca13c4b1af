// Percentiles of a short stretch of time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace aurasim::records {

/// The value below which the share `q` (0..1) of `values` lies (nearest rank); 0 for none. Reorders `values`.
inline double percentile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  const auto rank = std::min(values.size() - 1, static_cast<std::size_t>(q * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace aurasim::records
