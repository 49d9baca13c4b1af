// Straight lines through points, by least squares.
#pragma once

#include <span>
#include <vector>

namespace aurasim::lab {

struct Line {
  double intercept = 0;
  double slope = 0;

  double at(double x) const { return intercept + slope * x; }
};

/// The line with the least sum of squared distances in y. If all x are equal, a flat line through the mean of y. `xs`
/// and `ys` have the same length, at least 1.
Line fitted_line(std::span<const double> xs, std::span<const double> ys);

/// Line fitted to log10(ys), as the thesis describes frame times over bodies (section 5.1.3). Precondition: all ys are
/// above 0.
Line fitted_growth(std::span<const double> xs, std::span<const double> ys);

double median(std::vector<double> values);

}  // namespace aurasim::lab
