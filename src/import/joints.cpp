#include "import/joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace aurasim::importing {
namespace {

using core::JointLimits;
using core::Vec3;
using std::numbers::pi;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kFarthestWay = 1e7;      ///< m; a scene's limits of a slider
constexpr double kMostTurns = 1999 * pi;  ///< rad; a scene's limits of a hinge
constexpr double kSquare = 1e-9;          ///< cosine of the angle between axes that count as perpendicular

/// Returns the limits; a limit beyond `farthest` counts as none.
std::optional<JointLimits> limits_within(double farthest, const AxisRule& rule) {
  const JointLimits limits{rule.low < -farthest ? -kInfinite : rule.low, rule.high > farthest ? kInfinite : rule.high};
  if (std::isinf(limits.low) && std::isinf(limits.high)) return std::nullopt;
  return limits;
}

/// Returns the limits of a turning axis among several.
std::optional<JointLimits> turn_limits(const AxisRule& rule, const std::string& element, Model& model) {
  if (rule.low >= -pi && rule.high <= pi) return JointLimits{rule.low, rule.high};
  if (std::isfinite(rule.low) || std::isfinite(rule.high)) {
    model.lose(element,
               fmt::format("its limits, {:.6g} to {:.6g} rad: those of several axes together are within half a "
                           "turn either way; it is left free",
                           rule.low, rule.high));
  }
  return std::nullopt;
}

/// Returns the spring of an axis. A spring has stiffness and damping, but no friction and no limit of force, so a drive
/// becomes a part of them.
core::SpringAxis spring_axis(const AxisRule& rule, const std::string& element, Model& model) {
  core::SpringAxis axis;
  axis.limits = rule.turns ? turn_limits(rule, element, model) : limits_within(kFarthestWay, rule);
  const core::JointResistance& own = rule.resistance;
  const core::JointDrive drive = rule.drive.value_or(core::JointDrive{});
  axis.stiffness = own.stiffness + drive.stiffness;
  axis.damping = own.damping + drive.damping;
  const double pull = own.stiffness * own.rest + drive.stiffness * drive.position + drive.effort;
  if (axis.stiffness > 0) axis.rest = pull / axis.stiffness;
  if (axis.stiffness == 0 && pull != 0) model.lose(element, "a steady force on one of several axes");
  if (own.friction != 0) model.lose(element, fmt::format("friction {} of one of several axes", own.friction));
  if (axis.stiffness + axis.damping > 0 && std::isfinite(drive.max_effort))
    model.lose(element, fmt::format("that its drive is no stronger than {}: one of several axes", drive.max_effort));
  return axis;
}

core::SpringJoint all_locked() {
  core::SpringJoint spring;
  for (core::SpringAxis& axis : spring.axes) axis.limits = JointLimits{};
  return spring;
}

/// The axes of J. One to three are given; the others are chosen.
struct Triad {
  std::array<std::optional<Vec3>, 3> given;
  core::Mat3 axes = core::Mat3::Identity();
  bool third_turned_over = false;  ///< the z axis is opposite to the given one

  bool is_square() const {
    for (int i = 0; i < 3; ++i) {
      const auto& a = given[i];
      const auto& b = given[(i + 1) % 3];
      if (a && b && std::abs(a->dot(*b)) > kSquare) return false;
    }
    return true;
  }

  void complete() {
    for (int i = 0; i < 3; ++i) {  // one axis is given: choose any perpendicular one
      const int next = (i + 1) % 3, last = (i + 2) % 3;
      if (given[i] && !given[next] && !given[last]) given[next] = axis_frame(*given[i]) * Vec3::UnitX();
    }
    for (int i = 0; i < 3; ++i) {
      const int next = (i + 1) % 3, last = (i + 2) % 3;
      if (!given[i]) given[i] = given[next]->cross(*given[last]);
      axes.col(i) = *given[i];
    }
    third_turned_over = axes.determinant() < 0;
    if (third_turned_over) axes.col(2) *= -1;
  }
};

/// Axes (0 x, 1 y, 2 z) about which the first, second and third of `count` turns go. Two turns use x and z, because a
/// scene's joint cannot turn about y by a quarter or more.
std::vector<int> turn_slots(std::size_t count) {
  if (count == 0) return {};
  if (count == 1) return {2};
  if (count == 2) return {0, 2};
  return {0, 1, 2};
}

/// Gives the sliding axes the axes of J that the turning ones have left.
void choose_axes_of_ways(const std::vector<AxisRule>& ways, Triad& triad) {
  for (const AxisRule& rule : ways) {
    const Vec3 axis = rule.axis_W.normalized();
    bool is_new = true;
    for (const auto& other : triad.given) is_new = is_new && !(other && std::abs(other->dot(axis)) > kSquare);
    const auto free = std::find(triad.given.begin(), triad.given.end(), std::nullopt);
    if (is_new && free != triad.given.end()) *free = axis;
  }
}

AxisRule turned_over(AxisRule rule) {
  rule.axis_W = -rule.axis_W;
  std::swap(rule.low, rule.high);
  rule.low = -rule.low;
  rule.high = -rule.high;
  rule.resistance.rest *= -1;
  if (rule.drive) rule.drive->position *= -1, rule.drive->speed *= -1, rule.drive->effort *= -1;
  return rule;
}

}  // namespace

core::Quat axis_frame(const Vec3& axis_W) { return core::Quat::FromTwoVectors(Vec3::UnitZ(), axis_W); }

core::JointKind one_axis_kind(const AxisRule& rule) {
  if (rule.turns) return core::HingeJoint{limits_within(kMostTurns, rule), {}, rule.resistance, rule.drive};
  return core::SliderJoint{limits_within(kFarthestWay, rule), rule.resistance, rule.drive};
}

std::optional<SeveralAxes> several_axes_kind(const std::vector<AxisRule>& rules, const std::string& element,
                                             Model& model) {
  std::vector<AxisRule> ways, turns;
  for (const AxisRule& rule : rules) {
    if (!rule.turns && !turns.empty()) return std::nullopt;
    (rule.turns ? turns : ways).push_back(rule);
  }
  if (ways.size() > 3 || turns.size() > 3) return std::nullopt;
  // Sliding and turning axes share the axes of J. The order of turns matters, so they choose first; then each sliding
  // axis has to lie along one of them.
  Triad triad;
  const std::vector<int> slots = turn_slots(turns.size());
  for (std::size_t i = 0; i < turns.size(); ++i) triad.given[slots[i]] = turns[i].axis_W.normalized();
  choose_axes_of_ways(ways, triad);
  if (!triad.is_square()) return std::nullopt;
  if (turns.size() == 3 && !(turns[1].low > -pi / 2 && turns[1].high < pi / 2)) return std::nullopt;
  triad.complete();
  core::SpringJoint spring = all_locked();
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const AxisRule rule = slots[i] == 2 && triad.third_turned_over ? turned_over(turns[i]) : turns[i];
    spring.axes[3 + slots[i]] = spring_axis(rule, element, model);
  }
  for (AxisRule rule : ways) {
    const Vec3 along = triad.axes.transpose() * rule.axis_W.normalized();
    Eigen::Index i = 0;
    if (along.cwiseAbs().maxCoeff(&i) < 1 - kSquare) return std::nullopt;
    if (along[i] < 0) rule = turned_over(rule);
    spring.axes[i] = spring_axis(rule, element, model);
  }
  return SeveralAxes{spring, core::Quat(triad.axes)};
}

}  // namespace aurasim::importing
