#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "aurasim.h"
#include "core/block.h"
#include "messages/bearable.h"
#include "messages/codec.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::BodyId;
using core::HandOff;
using core::RegionId;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

void encode_bodies(const std::vector<core::BodyRecord>& bodies, wire::Migration& out) {
  using Body = core::BodyRecord;
  fill(out.body_id(), bodies, [](const Body& b) { return value_of(b.id); });
  fill(out.body_epoch(), bodies, [](const Body& b) { return b.epoch; });
  fill(out.body_prototype(), bodies, [](const Body& b) { return value_of(b.prototype); });
  fill(out.body_birth(), bodies, [](const Body& b) { return b.birth; });
  fill(out.body_activation_state(), bodies, [](const Body& b) { return b.activation_state; });
  fill(out.body_deactivation_time(), bodies, [](const Body& b) { return b.deactivation_time; });
  fill_wide<3>(out.body_p_WB(), bodies, [](const Body& b, double* to) { put_vector(b.p_WB, to); });
  fill_wide<9>(out.body_R_WB(), bodies, [](const Body& b, double* to) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{to} = b.R_WB;
  });
  fill_wide<3>(out.body_v_WB(), bodies, [](const Body& b, double* to) { put_vector(b.v_WB, to); });
  fill_wide<3>(out.body_w_WB(), bodies, [](const Body& b, double* to) { put_vector(b.w_WB, to); });
  fill_wide<2>(out.body_block(), bodies, [](const Body& b, std::int32_t* to) { to[0] = b.block.x, to[1] = b.block.y; });
}

void encode_memory(const core::ClusterState& cluster, wire::Migration& out) {
  using Manifold = core::ManifoldRecord;
  using Joint = core::JointRecord;
  fill(out.manifold_object0(), cluster.manifolds, [](const Manifold& m) { return m.object0; });
  fill(out.manifold_object1(), cluster.manifolds, [](const Manifold& m) { return m.object1; });
  fill(out.manifold_first_point(), cluster.manifolds, [](const Manifold& m) { return m.first_point; });
  fill(out.manifold_point_count(), cluster.manifolds, [](const Manifold& m) { return m.point_count; });
  out.points().assign(cluster.points.begin(), cluster.points.end());
  fill(out.joint_id(), cluster.joints, [](const Joint& j) { return value_of(j.id); });
  fill(out.joint_first_value(), cluster.joints, [](const Joint& j) { return j.first_value; });
  fill(out.joint_value_count(), cluster.joints, [](const Joint& j) { return j.value_count; });
  out.joint_values().assign(cluster.joint_values.begin(), cluster.joint_values.end());
}

MaybeError check_shape(const wire::Migration& in) {
  const std::size_t bodies = in.body_id().size();
  const std::size_t manifolds = in.manifold_object0().size();
  const std::size_t joints = in.joint_id().size();
  if (std::max({bodies, manifolds, joints}) > kMaxRows) {
    return WireError::kTooLarge;
  }
  const bool fits = same_rows(bodies, {{in.body_epoch().size()},
                                       {in.body_prototype().size()},
                                       {in.body_birth().size()},
                                       {in.body_activation_state().size()},
                                       {in.body_deactivation_time().size()},
                                       {in.body_p_WB().size(), 3},
                                       {in.body_R_WB().size(), 9},
                                       {in.body_v_WB().size(), 3},
                                       {in.body_w_WB().size(), 3},
                                       {in.body_block().size(), 2}}) &&
                    same_rows(manifolds, {{in.manifold_object1().size()},
                                          {in.manifold_first_point().size()},
                                          {in.manifold_point_count().size()}}) &&
                    same_rows(joints, {{in.joint_first_value().size()}, {in.joint_value_count().size()}}) &&
                    in.points().size() % core::kContactPointDoubles == 0;
  return fits ? MaybeError{} : WireError::kLength;
}

bool rotation_matrices(const std::vector<double>& R) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  for (std::size_t i = 0; i < R.size(); i += 9) {
    const Eigen::Map<const RowMajor> R_WB(R.data() + i);
    const core::Mat3 error = R_WB * R_WB.transpose() - core::Mat3::Identity();
    if (!(error.cwiseAbs().maxCoeff() <= kRotationTolerance) || !(R_WB.determinant() > 0)) {
      return false;
    }
  }
  return true;
}

/// True when rows [first, first + count) of every record lie inside `rows`.
bool spans_inside(const std::vector<std::uint32_t>& first, const std::vector<std::uint32_t>& count, std::size_t rows) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (std::uint64_t{first[i]} + count[i] > rows) {
      return false;
    }
  }
  return true;
}

/// True when `object` is a body of this very cluster or a static of the scene.
bool known_object(std::int64_t object, const wire::Migration& in, const Expected& expected) {
  if (object < 0) {
    return -(object + 1) < std::int64_t{expected.static_count};
  }
  return std::ranges::binary_search(in.body_id(), static_cast<std::uint64_t>(object));
}

/// True if each contact is that of a body of the cluster. Where regions are coupled, the other body may be one of
/// another region.
bool known_objects(const wire::Migration& in, const Expected& expected) {
  const auto is_possible = [&](std::int64_t object) { return object >= 0 || known_object(object, in, expected); };
  const auto is_here = [&](std::int64_t object) { return object >= 0 && known_object(object, in, expected); };
  for (std::size_t i = 0; i < in.manifold_object0().size(); ++i) {
    const std::int64_t object0 = in.manifold_object0()[i];
    const std::int64_t object1 = in.manifold_object1()[i];
    if (object0 == object1 || !is_possible(object0) || !is_possible(object1)) return false;
    if (!is_here(object0) && !is_here(object1)) return false;
  }
  return true;
}

/// True when a block is not known, or lies where a body may be.
bool are_bearable_blocks(const std::vector<std::int32_t>& blocks) {
  constexpr auto kMost = static_cast<std::int64_t>(bearable::kFarthest_m / core::kSmallestBlock_m);
  for (std::size_t i = 0; i < blocks.size(); i += 2) {
    const core::Block block{blocks[i], blocks[i + 1]};
    if (block.is_known() && (std::abs(std::int64_t{block.x}) > kMost || std::abs(std::int64_t{block.y}) > kMost))
      return false;
  }
  return true;
}

/// True when all quantities are within messages/bearable.h.
bool are_bearable(const wire::Migration& in) {
  using namespace bearable;
  constexpr std::array kWholeColumns = {26, 27, 37, 38, 39, 40};  // columns of a contact that are read as int
  constexpr double kMostInt = std::numeric_limits<std::int32_t>::max();
  for (std::size_t row = 0; row < in.points().size(); row += core::kContactPointDoubles) {
    for (const int column : kWholeColumns) {
      if (std::abs(in.points()[row + static_cast<std::size_t>(column)]) > kMostInt) return false;
    }
  }
  return all_within(in.body_p_WB(), kFarthest_m) && all_within(in.body_v_WB(), kFastest_m_s) &&
         all_within(in.body_w_WB(), kFastestSpin_rad_s) &&
         all_within(in.body_deactivation_time(), kLargestOfAContact) && all_within(in.points(), kLargestOfAContact) &&
         all_within(in.joint_values(), kLargestOfAContact) && all_below(in.body_epoch(), kMostEpochs) &&
         are_bearable_blocks(in.body_block());
}

MaybeError check_values(const wire::Migration& in, const Expected& expected) {
  if (!all_finite(in.body_p_WB()) || !all_finite(in.body_R_WB()) || !all_finite(in.body_v_WB()) ||
      !all_finite(in.body_w_WB()) || !all_finite(in.body_deactivation_time()) || !all_finite(in.points()) ||
      !all_finite(in.joint_values())) {
    return WireError::kNotFinite;
  }
  const bool states_known =
      std::ranges::all_of(in.body_activation_state(), [](std::int32_t state) { return state >= 1 && state <= 5; });
  if (in.reason() > static_cast<std::uint8_t>(core::HandOffReason::kBoundaryTraversal) || !states_known) {
    return WireError::kEnum;
  }
  if (!rotation_matrices(in.body_R_WB())) {
    return WireError::kRotation;
  }
  const bool in_range = in.stamp() >= 0 && in.sequence_number() >= 1 && !in.body_id().empty() && are_bearable(in) &&
                        strictly_ascending(in.body_id()) && all_body_ids(in.body_id()) &&
                        all_below(in.body_prototype(), expected.prototype_count) && none_negative(in.body_birth()) &&
                        none_negative(in.body_deactivation_time()) &&
                        spans_inside(in.manifold_first_point(), in.manifold_point_count(),
                                     in.points().size() / core::kContactPointDoubles) &&
                        known_objects(in, expected) && all_below(in.joint_id(), expected.joint_count) &&
                        spans_inside(in.joint_first_value(), in.joint_value_count(), in.joint_values().size());
  return in_range ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::Migration& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) {
    return error;
  }
  if (const auto error = check_source(in, expected)) {
    return error;
  }
  if (const auto error = check_destination(in, expected)) {
    return error;
  }
  if (const auto error = check_shape(in)) {
    return error;
  }
  return check_values(in, expected);
}

core::BodyRecord body_at(const wire::Migration& in, std::size_t i) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return {.id = static_cast<BodyId>(in.body_id()[i]),
          .epoch = in.body_epoch()[i],
          .prototype = static_cast<core::PrototypeId>(in.body_prototype()[i]),
          .birth = in.body_birth()[i],
          .activation_state = in.body_activation_state()[i],
          .deactivation_time = in.body_deactivation_time()[i],
          .p_WB = vector_at(in.body_p_WB(), i),
          .R_WB = Eigen::Map<const RowMajor>(in.body_R_WB().data() + 9 * i),
          .v_WB = vector_at(in.body_v_WB(), i),
          .w_WB = vector_at(in.body_w_WB(), i),
          .block = {in.body_block()[2 * i], in.body_block()[2 * i + 1]}};
}

core::ClusterState cluster_of(const wire::Migration& in) {
  core::ClusterState cluster;
  cluster.bodies.reserve(in.body_id().size());
  for (std::size_t i = 0; i < in.body_id().size(); ++i) {
    cluster.bodies.push_back(body_at(in, i));
  }
  cluster.manifolds.reserve(in.manifold_object0().size());
  for (std::size_t i = 0; i < in.manifold_object0().size(); ++i) {
    cluster.manifolds.push_back({.object0 = in.manifold_object0()[i],
                                 .object1 = in.manifold_object1()[i],
                                 .first_point = in.manifold_first_point()[i],
                                 .point_count = in.manifold_point_count()[i]});
  }
  cluster.points = in.points();
  cluster.joints.reserve(in.joint_id().size());
  for (std::size_t i = 0; i < in.joint_id().size(); ++i) {
    cluster.joints.push_back({.id = static_cast<core::JointId>(in.joint_id()[i]),
                              .first_value = in.joint_first_value()[i],
                              .value_count = in.joint_value_count()[i]});
  }
  cluster.joint_values = in.joint_values();
  return cluster;
}

}  // namespace

void encode(const HandOff& hand_off, wire::Migration& out) {
  out.source(value_of(hand_off.source));
  out.destination(value_of(hand_off.destination));
  out.version(kProtocolVersion);
  out.generation(hand_off.generation);
  out.redo(hand_off.redo);
  out.stamp(hand_off.stamp);
  out.map_version(hand_off.map_version);
  out.sequence_number(hand_off.sequence);
  out.reason(static_cast<std::uint8_t>(hand_off.reason));
  encode_bodies(hand_off.cluster.bodies, out);
  encode_memory(hand_off.cluster, out);
}

Decoded<HandOff> decode(const wire::Migration& in, const Expected& expected) {
  if (const auto error = check(in, expected)) {
    return *error;
  }
  core::ClusterState cluster = cluster_of(in);
  if (expected.block_m > 0 && !core::blocks_are_near(cluster.bodies, expected.block_m)) {
    return WireError::kRange;
  }
  return HandOff{.source = static_cast<RegionId>(in.source()),
                 .destination = static_cast<RegionId>(in.destination()),
                 .generation = in.generation(),
                 .redo = in.redo(),
                 .stamp = in.stamp(),
                 .map_version = in.map_version(),
                 .sequence = in.sequence_number(),
                 .reason = static_cast<core::HandOffReason>(in.reason()),
                 .cluster = std::move(cluster)};
}

}  // namespace aurasim::messages
