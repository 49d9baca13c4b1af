#include "core/static_path.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr double kTiny = 1e-9;

Quat yaw(double deg) { return Quat(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Vec3::UnitZ())); }
double yaw_of(const Pose& pose) {
  const Vec3 x = pose.q_WB * Vec3::UnitX();
  return std::atan2(x.y(), x.x()) * 180 / std::numbers::pi;
}

StaticBody on_path(StaticPath path) {
  StaticBody body;
  body.pose = {{10, 20, 30}, yaw(90)};
  body.path = std::move(path);
  return body;
}

TEST(StaticPath, LeadsFromStopToStopInTheStaticsOwnAxes) {
  const StaticBody lift = on_path({{{2, {{4, 0, 1}, yaw(0)}}, {3, {{4, 0, 1}, yaw(0)}}}, false, false});
  EXPECT_TRUE(pose_at(lift, 0).p_WB.isApprox(Vec3(10, 20, 30), kTiny));
  EXPECT_TRUE(pose_at(lift, 1).p_WB.isApprox(Vec3(10, 22, 30.5), kTiny));
  EXPECT_TRUE(pose_at(lift, 2.5).p_WB.isApprox(Vec3(10, 24, 31), kTiny));
  EXPECT_TRUE(pose_at(lift, 1000).p_WB.isApprox(Vec3(10, 24, 31), kTiny)) << "it stays at the last stop";
}

TEST(StaticPath, TurnsEvenlyOnTheShorterWay) {
  const StaticBody wheel = on_path(
      {{{1, {Vec3::Zero(), yaw(120)}}, {2, {Vec3::Zero(), yaw(240)}}, {3, {Vec3::Zero(), yaw(360)}}}, true, false});
  for (int i = 1; i < 900; ++i) {
    const double turned = yaw_of(pose_at(wheel, 0.01 * i)) - (90 + 1.2 * i);
    EXPECT_NEAR(std::remainder(turned, 360), 0, 1e-5) << i;
  }
}

TEST(StaticPath, ThatIsSmoothHasNoJumpsOfSpeed) {
  const StaticBody gate = on_path({{{1, {{2, 0, 0}, yaw(90)}}, {2.5, {Vec3::Zero(), yaw(0)}}}, true, true});
  constexpr double kStep_s = 1e-3;
  Twist before;
  for (int i = 0; i < 6000; ++i) {
    const Twist now = twist_between(pose_at(gate, i * kStep_s), pose_at(gate, (i + 1) * kStep_s), kStep_s);
    EXPECT_LT((now.v_W - before.v_W).norm(), 0.02) << i;
    EXPECT_LT((now.w_W - before.w_W).norm(), 0.02) << i;
    before = now;
  }
}

TEST(StaticPath, ItsTwistLeadsFromOnePoseToTheNext) {
  const Pose before{{1, 2, 3}, Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()))};
  const Vec3 w(0.5, -2, 1);
  const Pose after{{1.1, 2, 2.9}, (Quat(Eigen::AngleAxisd(0.1 * w.norm(), w.normalized())) * before.q_WB).normalized()};
  const Twist twist = twist_between(before, after, 0.1);
  EXPECT_TRUE(twist.v_W.isApprox(Vec3(1, 0, -1), 1e-9));
  EXPECT_TRUE(twist.w_W.isApprox(w, 1e-6)) << twist.w_W.transpose();
  Pose same_turn = after;
  same_turn.q_WB.coeffs() = -after.q_WB.coeffs();
  EXPECT_TRUE(twist_between(before, same_turn, 0.1).w_W.isApprox(w, 1e-6));
}

}  // namespace
}  // namespace aurasim::core
