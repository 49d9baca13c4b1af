#include "physics/joint_axes.h"

#include <initializer_list>
#include <optional>
#include <variant>

namespace aurasim::physics {
namespace {

class Maker {
 public:
  Maker(JointAxes& joint, double times) : joint_(joint), times_(times) {}

  void operator()(const core::BallJoint&) const { hold({0, 1, 2}); }

  void operator()(const core::HingeJoint& hinge) const {
    hold({0, 1, 2, 3, 4});
    limit(5, hinge.limits);
    if (!hinge.motor) return;
    joint_.has_motor = true;
    joint_.motor_rad_s = hinge.motor->speed;
    joint_.motor_impulse = times_ * hinge.motor->max_impulse;
  }

  void operator()(const core::SliderJoint& slider) const {
    hold({0, 1, 3, 4, 5});
    limit(2, slider.limits);
  }

  void operator()(const core::FixedJoint&) const { hold({0, 1, 2, 3, 4, 5}); }

  void operator()(const core::SpringJoint& spring) const {
    joint_.b_is_first = true;
    for (std::size_t i = 0; i < spring.axes.size(); ++i) {
      limit(i, spring.axes[i].limits);
      joint_.axes[i].stiffness = spring.axes[i].stiffness;
      joint_.axes[i].damping = spring.axes[i].damping;
    }
  }

 private:
  void hold(std::initializer_list<std::size_t> axes) const {
    for (const std::size_t i : axes) limit(i, core::JointLimits{});
  }
  void limit(std::size_t i, const std::optional<core::JointLimits>& limits) const {
    if (!limits) return;
    joint_.axes[i].is_held = true;
    joint_.axes[i].low = limits->low, joint_.axes[i].high = limits->high;
  }

  JointAxes& joint_;
  double times_;  ///< the impulses of kImpulseTime_s
};

}  // namespace

JointAxes axes_of(const core::JointSpec& joint, const JointFrames& frames, double substep_s) {
  JointAxes axes;
  const double times = substep_s / kImpulseTime_s;
  axes.frames = frames;
  axes.break_impulse = times * joint.break_impulse;
  std::visit(Maker(axes, times), joint.kind);
  return axes;
}

}  // namespace aurasim::physics
