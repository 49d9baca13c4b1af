// A world in one state, or the part of it that one region has: all that a run needs to go on from there with the same
// bits, on any map (docs/design.md, "The cut").
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/order.h"
#include "core/setpoint.h"

namespace aurasim::core {

/// A cluster that had left one region in state `stamp` or before, and had not come to the other.
struct UnderWay {
  Step stamp = 0;
  ClusterState cluster;
};

/// What a client's mesh has become in a scene.
struct SavedShape {
  MeshRef mesh;
  Shape shape;
};

/// A client's mesh as it came: for those who look on.
struct SavedMesh {
  std::uint64_t hash = 0;
  TriangleMesh mesh;
};

struct WorldCut {
  Step step = 0;
  Step births_known = 0;  ///< bodies born up to this state are among `bodies`, or are no more
  ClusterState bodies;
  std::vector<UnderWay> under_way;
  /// Ascending sequence: all that have changed the scene, and those that take effect later than this state or than the
  /// oldest cluster under way.
  std::vector<Order> orders;
  std::uint64_t last_order = 0;  ///< the sequence number of the newest, also of what has been left out
  std::vector<SavedShape> shapes;
  std::vector<SavedMesh> meshes;
  std::vector<Setpoints> setpoints;  ///< in effect in this state, or in those of clusters under way, and later
};

/// The whole from the parts of all regions. Throws std::invalid_argument when they are not of one state, or when two of
/// them have the same body.
WorldCut merge(std::vector<WorldCut> parts);

/// All bodies, also those under way: how many?
std::size_t body_count(const WorldCut& cut);

}  // namespace aurasim::core
