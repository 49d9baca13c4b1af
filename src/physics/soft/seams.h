// The order in which the soft step solves contacts, by blocks (core/block.h, docs/design.md, "Blocks").
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/block.h"

namespace aurasim::physics {

/// The phases of a sweep, in their order. The contacts of a phase form groups; no body is in two groups of a phase.
/// Contacts with statics come last, after these.
enum class SoftPhase : std::uint8_t {
  kInside,  ///< both bodies have one block, which is the group
  /// The group: contacts across edges around one corner of four blocks, but those of kEdges. Before kEdges, because who
  /// solves contacts across an edge usually solves those around its corners, too, and so knows their result.
  kCorners,
  kEdges,   ///< the group: all contacts across one edge of two blocks between bodies that are nearest to it
  kGiants,  ///< all others, in one group
};
inline constexpr std::size_t kSoftPhases = 4;

/// The bit of a phase in a set of phases.
inline std::uint8_t bit_of(SoftPhase phase) { return static_cast<std::uint8_t>(1U << static_cast<unsigned>(phase)); }

/// Where a body of the soft step is among the blocks. Of each phase, it names the only group that the body can be in.
struct SoftPlace {
  core::Block block{0, 0};
  /// The edge of the block that is nearest to the centre: the block east or north of it, and whether it runs along x.
  core::Block edge{0, 0};
  bool edge_runs_along_x = false;
  core::Block corner{0, 0};  ///< the corner that is nearest to the centre: the block north-east of it
  bool is_giant = false;     ///< too large for edges and corners
};

inline SoftPlace soft_place(const core::Vec3& p_WB, const core::Block& block, double radius_m, double side_m) {
  const double x = p_WB.x() - side_m * (block.x + 0.5), y = p_WB.y() - side_m * (block.y + 0.5);  // from the middle
  const std::int32_t east = x > 0 ? 1 : 0, north = y > 0 ? 1 : 0;
  SoftPlace place;
  place.block = block;
  place.edge_runs_along_x = std::abs(y) > std::abs(x);
  place.edge = place.edge_runs_along_x ? core::Block{block.x, block.y + north} : core::Block{block.x + east, block.y};
  place.corner = {block.x + east, block.y + north};
  const double most_m = core::kBlockRadius * side_m;
  place.is_giant =
      radius_m > most_m || radius_m + core::outside_m(p_WB, block, side_m) > most_m + core::kBlockMargin * side_m;
  return place;
}

/// The phase of a contact between two bodies that are not static. In its phase, the contact is in the group that each
/// of the two can be in, so no body is in two groups.
inline SoftPhase phase_of(const SoftPlace& a, const SoftPlace& b) {
  if (a.is_giant || b.is_giant) return SoftPhase::kGiants;
  if (a.block == b.block) return SoftPhase::kInside;
  if (a.edge == b.edge && a.edge_runs_along_x == b.edge_runs_along_x) return SoftPhase::kEdges;
  return a.corner == b.corner ? SoftPhase::kCorners : SoftPhase::kGiants;
}

/// Number of a contact's group in its phase, below kSoftGroups. `place`: of one of the two bodies. Groups that are 16
/// blocks apart have the same number, and count as one.
inline constexpr std::size_t kSoftGroups = 512;
inline std::size_t group_of(SoftPhase phase, const SoftPlace& place) {
  const auto number = [](const core::Block& block) {
    return static_cast<std::size_t>(block.x & 15) << 4U | static_cast<std::size_t>(block.y & 15);
  };
  switch (phase) {
    case SoftPhase::kInside:
      return number(place.block);
    case SoftPhase::kEdges:
      return number(place.edge) + (place.edge_runs_along_x ? kSoftGroups / 2 : 0);
    case SoftPhase::kCorners:
      return number(place.corner);
    case SoftPhase::kGiants:
      break;
  }
  return 0;
}

}  // namespace aurasim::physics
