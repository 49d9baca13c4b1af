#include "overseer/eye.h"

#include <algorithm>
#include <cmath>

namespace aurasim::overseer {
namespace {

/// Margin around the picture, because a body reaches beyond its centre, and its shadow beyond the body.
constexpr double kBesidePicture_m = 3;
/// Error outside of the picture, metres. With this error a body is roughly where it is expected when the page turns to
/// it; then its exact place is sent.
constexpr double kOutsideError_m = 0.5;

}  // namespace

double unseen_error_m(const Eye& eye, const core::Vec3& p_W) {
  const core::Vec3 line = p_W - eye.p_W;
  const double distance_m = line.norm();
  const double half_pixel_m = 0.5 * eye.pixel_rad * distance_m;
  if (distance_m <= kBesidePicture_m) return half_pixel_m;
  const double angle_rad = std::acos(std::clamp(line.dot(eye.towards_W) / distance_m, -1.0, 1.0));
  const bool in_picture = angle_rad <= eye.half_angle_rad + std::asin(kBesidePicture_m / distance_m);
  return in_picture ? half_pixel_m : std::max(half_pixel_m, kOutsideError_m);
}

}  // namespace aurasim::overseer
