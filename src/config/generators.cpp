#include "config/generators.h"

#include <numbers>

#include <fmt/format.h>

#include "config/generator_keys.h"
#include "config/shapes.h"

namespace aurasim::config {
namespace {

using core::Vec3;

constexpr double kSmallestStep = 1e-6;

/// A chain: bodies connected by ball joints.
struct Chain {
  Vec3 step_F = Vec3::UnitX();
  bool first_anchored = false;
  bool last_anchored = false;
};

/// Values that all formations have. F is the formation's frame: origin at `position`, x along its rows, z up.
struct Formation {
  core::PrototypeId prototype{};
  Bounds bounds;  ///< bounds of the shape, in the body's frame
  core::Pose X_WF;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
  double gap_m = 0;
  std::optional<std::string> name;
  std::optional<Chain> chain;
  std::vector<Vec3> centres_F;  ///< centres of the bodies' bounds, bottom at z = 0

  double width_m() const { return bounds.size().x() + gap_m; }
};

double as_double(std::int64_t n) { return static_cast<double>(n); }

void read_common(const Fields& fields, Formation& formation, SceneDraft& draft) {
  if (const auto index = fields.given() ? draft.prototypes.find(fields["prototype"]) : std::nullopt) {
    formation.prototype = core::PrototypeId{*index};
    const std::uint32_t shape = draft.scene.prototypes[*index].shape;
    if (shape < draft.scene.shapes.size()) formation.bounds = bounds_of(draft.scene.shapes[shape].shape);
  }
  formation.name = fields["name"].text();
  formation.X_WF.p_WB = fields["position"].vec3().value_or(Vec3::Zero());
  const double yaw_deg = fields["yaw_deg"].number().value_or(0);
  formation.X_WF.q_WB = core::Quat(Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Vec3::UnitZ()));
  formation.v_WB = fields["velocity"].vec3().value_or(Vec3::Zero());
  formation.w_WB = fields["spin"].vec3().value_or(Vec3::Zero());
}

void read_gap(const Fields& fields, Formation& formation) { formation.gap_m = fields["gap"].number().value_or(0); }

void place_stack(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  const Field count_field = fields["count"];
  const auto count = count_field.integer();
  if (!count || !draft.has_room_for(static_cast<std::uint64_t>(*count), count_field)) return;
  const double height = formation.bounds.size().z();
  for (std::int64_t i = 0; i < *count; ++i) formation.centres_F.push_back({0, 0, (as_double(i) + 0.5) * height});
}

void place_wall(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  read_gap(fields, formation);
  const auto rows = fields["rows"].integer();
  const auto columns = fields["columns"].integer();
  if (!rows || !columns) return;
  if (!draft.has_room_for(static_cast<std::uint64_t>(*rows * *columns), fields.whole())) return;
  const Vec3 size = formation.bounds.size();
  for (std::int64_t row = 0; row < *rows; ++row) {
    const double shift = row % 2 == 1 ? 0.5 : 0;
    for (std::int64_t column = 0; column < *columns; ++column) {
      const double x = (as_double(column) - 0.5 * as_double(*columns - 1) + shift) * formation.width_m();
      formation.centres_F.push_back({x, 0, (as_double(row) + 0.5) * size.z()});
    }
  }
}

void place_pyramid(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  read_gap(fields, formation);
  const Field rows_field = fields["rows"];
  const auto rows = rows_field.integer();
  if (!rows || !draft.has_room_for(static_cast<std::uint64_t>(*rows * (*rows + 1) / 2), rows_field)) return;
  const Vec3 size = formation.bounds.size();
  for (std::int64_t row = 0; row < *rows; ++row) {
    const std::int64_t columns = *rows - row;
    for (std::int64_t column = 0; column < columns; ++column) {
      const double x = (as_double(column) - 0.5 * as_double(columns - 1)) * formation.width_m();
      formation.centres_F.push_back({x, 0, (as_double(row) + 0.5) * size.z()});
    }
  }
}

void place_block(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  const Field counts_field = fields["counts"];
  std::vector<std::int64_t> counts;
  for (const Field& item : counts_field.items()) {
    if (const auto count = item.integer()) counts.push_back(*count);
  }
  const Vec3 size = formation.bounds.size();
  const Vec3 spacing = fields["spacing"].vec3().value_or(size);
  if (counts.size() != 3) return;
  const std::int64_t in_layer = counts[0] * counts[1];
  const std::int64_t all = in_layer > static_cast<std::int64_t>(kMostBodies) ? in_layer : in_layer * counts[2];
  if (!draft.has_room_for(static_cast<std::uint64_t>(all), counts_field)) return;
  for (std::int64_t z = 0; z < counts[2]; ++z) {
    for (std::int64_t y = 0; y < counts[1]; ++y) {
      for (std::int64_t x = 0; x < counts[0]; ++x) {
        formation.centres_F.push_back({(as_double(x) - 0.5 * as_double(counts[0] - 1)) * spacing.x(),
                                       (as_double(y) - 0.5 * as_double(counts[1] - 1)) * spacing.y(),
                                       as_double(z) * spacing.z() + 0.5 * size.z()});
      }
    }
  }
}

void place_row(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  const Field count_field = fields["count"];
  const auto count = count_field.integer();
  const auto step = fields["step"].vec3();
  if (!count || !step || !draft.has_room_for(static_cast<std::uint64_t>(*count), count_field)) return;
  const Vec3 first = 0.5 * (formation.bounds.low + formation.bounds.high);  // here `position` is a body's centre
  for (std::int64_t i = 0; i < *count; ++i) formation.centres_F.push_back(first + as_double(i) * *step);
}

void place_chain(const Fields& fields, Formation& formation, const SceneDraft& draft) {
  const Anchor anchor = fields["anchor"].choice<Anchor>().value_or(Anchor::kNone);
  place_row(fields, formation, draft);
  const Field step_field = fields["step"];
  const auto step = step_field.is_list() ? step_field.vec3() : std::nullopt;
  if (!step) return;
  if (step->norm() < kSmallestStep) {
    step_field.complain("found a step of length 0, allowed: from the centre of one body to that of the next");
    return;
  }
  formation.chain = Chain{*step, anchor == Anchor::kFirst || anchor == Anchor::kBoth,
                          anchor == Anchor::kLast || anchor == Anchor::kBoth};
}

/// Adds the joints. Precondition: the formation's bodies are the last ones in the draft.
void add_joints(const Formation& formation, SceneDraft& draft) {
  const std::size_t count = formation.centres_F.size();
  if (!formation.chain || count == 0) return;
  const std::size_t first = draft.bodies.size() - count;
  const auto join = [&](std::size_t a, std::optional<std::size_t> b, double steps) {
    DraftJoint joint;
    joint.a = first + a;
    if (b) joint.b = first + *b;
    joint.joint.X_WJ.p_WB =
        draft.bodies[joint.a].body.pose.p_WB + formation.X_WF.q_WB * (steps * formation.chain->step_F);
    joint.joint.X_WJ.q_WB = formation.X_WF.q_WB;
    joint.joint.name = fmt::format("{}.{}", formation.name.value_or("chain"), draft.joints.size());
    draft.joints.push_back(std::move(joint));
  };
  if (formation.chain->first_anchored) join(0, {}, -0.5);
  for (std::size_t i = 0; i + 1 < count; ++i) join(i, i + 1, 0.5);
  if (formation.chain->last_anchored) join(count - 1, {}, 0.5);
}

void add_bodies(const Formation& formation, const Field& blame, SceneDraft& draft) {
  const Vec3 p_BoC = 0.5 * (formation.bounds.low + formation.bounds.high);  // centre of the bounds in the body's frame
  core::Quat q_FB = core::Quat::Identity();
  if (formation.chain) q_FB = core::Quat::FromTwoVectors(Vec3::UnitZ(), formation.chain->step_F);
  std::size_t index = 0;
  std::optional<Vec3> too_far_W;
  for (const Vec3& p_FC : formation.centres_F) {
    DraftBody body;
    body.source = source_of(blame, formation.name ? fmt::format("{}.{}", *formation.name, index++) : "");
    if (formation.name) draft.name_next_body(body.source.name, blame);
    body.body.prototype = formation.prototype;
    body.body.pose.p_WB = formation.X_WF.p_WB + formation.X_WF.q_WB * (p_FC - q_FB * p_BoC);
    body.body.pose.q_WB = formation.X_WF.q_WB * q_FB;
    body.body.v_WB = formation.v_WB;
    body.body.w_WB = formation.w_WB;
    if (!too_far_W && !is_within_reach(body.body.pose.p_WB)) too_far_W = body.body.pose.p_WB;
    draft.bodies.push_back(body);
  }
  if (too_far_W) complain_of_place(blame, "a body", *too_far_W);
}

using Placement = void (*)(const Fields&, Formation&, const SceneDraft&);

void read_formation(const Field& field, Placement place, SceneDraft& draft) {
  const Fields fields(field);
  Formation formation;
  read_common(fields, formation, draft);
  place(fields, formation, draft);
  fields.close();
  if (draft.scene.prototypes.empty()) return;
  add_bodies(formation, field, draft);
  add_joints(formation, draft);
}

void read_generator(const Field& field, SceneDraft& draft) {
  constexpr std::pair<std::string_view, Placement> kKinds[] = {{"stack", place_stack},     {"wall", place_wall},
                                                               {"pyramid", place_pyramid}, {"block", place_block},
                                                               {"row", place_row},         {"chain", place_chain}};
  const Fields fields(field);
  for (const auto& [kind, place] : kKinds) {
    if (fields.has(kind)) read_formation(fields[kind], place, draft);
  }
  fields.close();
  if (fields.given() && fields.given_of(generator_keys()).size() != 1) {
    field.refuse("one of stack, wall, pyramid, block, row, chain");
  }
}

}  // namespace

void read_generators(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  for (const Field& item : field.items()) read_generator(item, draft);
}

}  // namespace aurasim::config
