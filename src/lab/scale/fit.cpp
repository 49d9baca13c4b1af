#include "lab/scale/fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace aurasim::lab {
namespace {

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace

Line fitted_line(std::span<const double> xs, std::span<const double> ys) {
  const double mx = mean(xs);
  const double my = mean(ys);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    xx += (xs[i] - mx) * (xs[i] - mx);
    xy += (xs[i] - mx) * (ys[i] - my);
  }
  const double slope = xx > 0 ? xy / xx : 0;
  return {my - slope * mx, slope};
}

Line fitted_growth(std::span<const double> xs, std::span<const double> ys) {
  std::vector<double> logs;
  for (const double y : ys) logs.push_back(std::log10(y));
  return fitted_line(xs, logs);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace aurasim::lab
