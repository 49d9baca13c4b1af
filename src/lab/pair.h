// Two bodies of different regions that are about to meet near a border. No gravity, no drag (thesis section 5.2.1).
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string_view>

#include "core/clearance.h"
#include "core/region_map.h"
#include "core/scene.h"
#include "lab/conditions.h"

namespace aurasim::lab {

enum class PairKind : std::uint8_t {
  kHeadOn,   ///< thesis figure 5.19: two spheres at the same speed; one is over the border when they touch
  kCorner,   ///< as kHeadOn, where four regions meet: one body is over the corner, in any direction
  kGrazing,  ///< two spheres that barely touch in passing
  kBoxes,    ///< two boxes, turned and spinning
  kCapsules,
  kRandom,  ///< any two of sphere, box and capsule, any directions and speeds up to that of the series
};
inline constexpr std::array kPairKinds = {PairKind::kHeadOn, PairKind::kCorner,   PairKind::kGrazing,
                                          PairKind::kBoxes,  PairKind::kCapsules, PairKind::kRandom};

std::string_view name_of(PairKind kind);

/// Uniform random numbers. The sequence depends on the seed only, not on the machine.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits_() % n); }
  /// Uniform on the unit sphere.
  core::Vec3 direction();
  /// Uniform over all rotations.
  core::Quat rotation();

 private:
  std::mt19937_64 bits_;
};

struct Pair {
  core::Scene scene;
  core::RegionMap map = core::RegionMap::columns(1, 1);
  core::Step expected_step = 0;  ///< state in which the bounding spheres meet
  core::Step passed_step = 0;    ///< from this state on they are past each other
};

/// Radius of the spheres, and of the spheres around the other shapes. The overlap of two bodies grows only until their
/// centres pass each other; with this radius a head-on pair at 96 m/s each overlaps more and more for two steps, so
/// that up to there every late contact looks late, and one world alone misses none.
inline constexpr double kRadius_m = 3.5;

/// Bodies as spheres of one radius.
class RoundShapes final : public core::ClearanceQuery {
 public:
  explicit RoundShapes(double radius_m) : radius_m_(radius_m) {}
  double bounding_radius(core::PrototypeId) const override { return radius_m_; }
  double clearance(core::PrototypeId, const core::Pose& a, core::PrototypeId, const core::Pose& b,
                   double) const override {
    return (a.p_WB - b.p_WB).norm() - 2 * radius_m_;
  }

 private:
  double radius_m_;
};

/// Makes a pair; its bodies have ids 0 and 1. They start so far apart that, at these tolerances, the nodes exchange
/// messages before any kind of aura predicts the meeting.
Pair make_pair(PairKind kind, const Conditions& conditions, Chance& chance);

}  // namespace aurasim::lab
