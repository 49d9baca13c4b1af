// Orders as the order_* columns of an AuraBatch. Kinds: the place of the action in core::Action. For each kind, what
// its subject, index and numbers mean:
//    0 define shape      hash of a mesh; 0 sphere, 1 box, 2 capsule, 3 cylinder, 4 hull, 5 decomposition, 6 triangles
//                        of the mesh; radius, half extents, or radius and height
//    1 define prototype  -; shape; mass
//    2 spawn             body; prototype; p q v w
//    3 add static        static; shape; p q
//    4, 5 remove         body or static
//    6 impulse           body; -; J and, if it is not the centre of mass, the point of attack
//    7 set velocity      body; -; v and, if it changes, w
//    8 repartition       -; -; x0 y0 x1 y1 of each region
//    9 change scene      -; -; - ; text: its name
//   10 redo              -; -; cut, and a, b, until of each pair
//   11 save, 12 load     -; -; - ; text: the file
#pragma once

#include <optional>
#include <vector>

#include "core/order.h"
#include "messages/wire_error.h"

namespace aurasim::wire {
class AuraBatch;
}

namespace aurasim::messages {

void encode_orders(const std::vector<core::Order>& orders, wire::AuraBatch& out);
/// Returns the orders of a batch after checking everything, or nothing if they are not well-formed.
std::optional<std::vector<core::Order>> decode_orders(const wire::AuraBatch& in);

}  // namespace aurasim::messages
