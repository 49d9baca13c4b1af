#include "messages/packed_rotation.h"

#include <cmath>
#include <numbers>

namespace aurasim::messages {
namespace {

constexpr int kBits = 20;
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
/// Scale of a component. The second largest component of a unit quaternion is at most 1 / sqrt(2).
constexpr double kScale = std::numbers::sqrt2 * double((1 << (kBits - 1)) - 1);

double signed_value(std::uint64_t field) {
  const auto raw = static_cast<std::int64_t>(field);
  return static_cast<double>(raw > std::int64_t(kMask >> 1) ? raw - std::int64_t(kMask) - 1 : raw) / kScale;
}

}  // namespace

std::uint64_t packed(const core::Quat& q) {
  Eigen::Vector4d c(q.w(), q.x(), q.y(), q.z());
  c.normalize();
  Eigen::Index largest = 0;
  c.cwiseAbs().maxCoeff(&largest);
  const double sign = c[largest] < 0 ? -1 : 1;
  auto bits = static_cast<std::uint64_t>(largest) << (3 * kBits);
  for (int i = 0, shift = 0; i < 4; ++i) {
    if (i == largest) continue;
    bits |= (static_cast<std::uint64_t>(std::llround(sign * c[i] * kScale)) & kMask) << shift;
    shift += kBits;
  }
  return bits;
}

std::optional<core::Quat> unpacked_rotation(std::uint64_t bits) {
  if (bits >> (3 * kBits + 2) != 0) return std::nullopt;
  const auto largest = static_cast<int>(bits >> (3 * kBits));
  Eigen::Vector4d c;
  double squares = 0;
  for (int i = 0, shift = 0; i < 4; ++i) {
    if (i == largest) continue;
    c[i] = signed_value((bits >> shift) & kMask);
    squares += c[i] * c[i];
    shift += kBits;
  }
  if (squares > 0.75 + 1e-4) return std::nullopt;  // the component left out is at least 1/2
  c[largest] = std::sqrt(1 - squares);
  return core::Quat(c[0], c[1], c[2], c[3]);
}

}  // namespace aurasim::messages
