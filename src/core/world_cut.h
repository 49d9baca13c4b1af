// A cut: a world in one state, or the part of it that one region has. Holds all that a run needs to go on from there
// with the same bits, on any map (docs/design.md, "The cut").
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/order.h"
#include "core/setpoint.h"

namespace aurasim::core {

/// A cluster under way in the cut: it had left one region in state `stamp` or before, and had not arrived in the other.
struct UnderWay {
  Step stamp = 0;
  ClusterState cluster;
};

/// The shape that a client's mesh has become in the scene.
struct SavedShape {
  MeshRef mesh;
  Shape shape;
};

/// A client's mesh as received. Kept for observers.
struct SavedMesh {
  std::uint64_t hash = 0;
  TriangleMesh mesh;
};

struct WorldCut {
  Step step = 0;
  Step births_known = 0;  ///< bodies born up to this state are among `bodies`, or have been removed
  ClusterState bodies;
  std::vector<UnderWay> under_way;
  /// Orders, ascending sequence: all that have changed the scene, and those that take effect after this state or after
  /// the stamp of the oldest cluster under way.
  std::vector<Order> orders;
  std::uint64_t last_order = 0;  ///< sequence number of the newest order, also if it is left out of `orders`
  std::vector<SavedShape> shapes;
  std::vector<SavedMesh> meshes;
  std::vector<Setpoints> setpoints;  ///< in effect in this state or later, or in the states of clusters under way
};

/// Merges the parts of all regions to the whole world. Throws std::invalid_argument if they are not of one state, or if
/// two of them have the same body.
WorldCut merge(std::vector<WorldCut> parts);

/// Number of all bodies, also of those under way.
std::size_t body_count(const WorldCut& cut);

}  // namespace aurasim::core
