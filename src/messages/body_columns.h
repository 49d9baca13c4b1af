// Encodes bodies as they are published to observers (core/replica.h), in the columns that topics replica and
// observation share: id, epoch, host, prototype, flags, p_WB, q_WB, v_WB, w_WB. Each topic has its own flags; only the
// first bit (kAsleep) is common.
#pragma once

#include <cstdint>
#include <vector>

#include "core/replica.h"
#include "messages/columns.h"

namespace aurasim::messages {

inline constexpr std::uint8_t kAsleep = 1;

inline void put_floats(const Eigen::Vector3f& v, float* out) {
  out[0] = v.x();
  out[1] = v.y();
  out[2] = v.z();
}

/// Fills all columns except the flags. `row_of(body)` returns the body's core::ReplicaBody.
template <class Body, class RowOf, class Wire>
void put_body_columns(const std::vector<Body>& bodies, const RowOf& row_of, Wire& out) {
  fill(out.id(), bodies, [&](const Body& b) { return core::value_of(row_of(b).id); });
  fill(out.epoch(), bodies, [&](const Body& b) { return row_of(b).epoch; });
  fill(out.host(), bodies, [&](const Body& b) { return core::value_of(row_of(b).host); });
  fill(out.prototype(), bodies, [&](const Body& b) { return core::value_of(row_of(b).prototype); });
  fill_wide<3>(out.p_WB(), bodies, [&](const Body& b, double* to) { put_vector(row_of(b).p_WB, to); });
  fill_wide<4>(out.q_WB(), bodies, [&](const Body& b, float* to) {
    const Eigen::Quaternionf& q = row_of(b).q_WB;
    to[0] = q.w(), to[1] = q.x(), to[2] = q.y(), to[3] = q.z();
  });
  fill_wide<3>(out.v_WB(), bodies, [&](const Body& b, float* to) { put_floats(row_of(b).v_WB, to); });
  fill_wide<3>(out.w_WB(), bodies, [&](const Body& b, float* to) { put_floats(row_of(b).w_WB, to); });
}

/// True when every column has one row for each id.
template <class Wire>
bool body_columns_fit(const Wire& in) {
  return same_rows(in.id().size(), {{in.epoch().size()},
                                    {in.host().size()},
                                    {in.prototype().size()},
                                    {in.flags().size()},
                                    {in.p_WB().size(), 3},
                                    {in.q_WB().size(), 4},
                                    {in.v_WB().size(), 3},
                                    {in.w_WB().size(), 3}});
}

template <class Wire>
bool body_columns_are_finite(const Wire& in) {
  return all_finite(in.p_WB()) && all_finite(in.q_WB()) && all_finite(in.v_WB()) && all_finite(in.w_WB());
}

/// Returns row i. Precondition: the columns fit and are finite (the two checks above).
template <class Wire>
core::ReplicaBody body_at(const Wire& in, std::size_t i) {
  const float* q = in.q_WB().data() + 4 * i;
  const float* v = in.v_WB().data() + 3 * i;
  const float* w = in.w_WB().data() + 3 * i;
  return {.id = static_cast<core::BodyId>(in.id()[i]),
          .epoch = in.epoch()[i],
          .host = static_cast<core::RegionId>(in.host()[i]),
          .prototype = static_cast<core::PrototypeId>(in.prototype()[i]),
          .asleep = (in.flags()[i] & kAsleep) != 0,
          .p_WB = vector_at(in.p_WB(), i),
          .q_WB = Eigen::Quaternionf(q[0], q[1], q[2], q[3]),
          .v_WB = {v[0], v[1], v[2]},
          .w_WB = {w[0], w[1], w[2]}};
}

}  // namespace aurasim::messages
