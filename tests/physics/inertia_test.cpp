#include "physics/inertia.h"

#include <cmath>

#include <gtest/gtest.h>

namespace aurasim::physics {
namespace {

using core::Vec3;

constexpr double kMass = 3;

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-9) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " instead of " << b.transpose();
}

core::ConvexHull cuboid(const Vec3& half, const Vec3& centre = Vec3::Zero()) {
  core::ConvexHull hull;
  for (int i = 0; i < 8; ++i) {
    hull.points.push_back(centre + half.cwiseProduct(Vec3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1)));
  }
  return hull;
}

Vec3 of_cuboid(const Vec3& half, double mass) {
  const Vec3 squares = half.cwiseAbs2();
  return mass / 3 * (Vec3::Constant(squares.sum()) - squares);
}

TEST(Inertia, OfASphere) { expect_near(inertia_diagonal(core::Sphere{2}, kMass), Vec3::Constant(0.4 * kMass * 4)); }

TEST(Inertia, OfABox) { expect_near(inertia_diagonal(core::Box{{1, 2, 3}}, kMass), of_cuboid({1, 2, 3}, kMass)); }

TEST(Inertia, OfACylinder) {
  const double across = kMass * (3 * 0.25 + 4) / 12;
  expect_near(inertia_diagonal(core::Cylinder{0.5, 2}, kMass), {across, across, kMass * 0.25 / 2});
}

TEST(Inertia, OfACapsuleWithoutHeightIsThatOfASphere) {
  expect_near(inertia_diagonal(core::Capsule{2, 0}, kMass), inertia_diagonal(core::Sphere{2}, kMass));
}

/// Cylinder and half spheres by the parallel axis theorem; a half sphere has 83/320 m r^2 about its centre of mass.
TEST(Inertia, OfACapsule) {
  const double r = 0.5, h = 2, pi = M_PI;
  const double cylinder = pi * r * r * h, cap = 2.0 / 3 * pi * r * r * r, density = kMass / (cylinder + 2 * cap);
  const double along = density * (cylinder * r * r / 2 + 2 * cap * 0.4 * r * r);
  const double across =
      density * (cylinder * (3 * r * r + h * h) / 12 + 2 * cap * (83.0 / 320 * r * r + std::pow(h / 2 + 3 * r / 8, 2)));
  expect_near(inertia_diagonal(core::Capsule{r, h}, kMass), {across, across, along});
}

/// Bullet's hulls are made of whole numbers, a few thousandths of a per cent apart.
TEST(Inertia, OfAHullIsThatOfItsSolid) {
  expect_near(inertia_diagonal(cuboid({1, 2, 3}), kMass), of_cuboid({1, 2, 3}, kMass), 0.01);
}

TEST(Inertia, OfACompoundIsThatOfItsPartsTogether) {
  core::Compound two_halves;
  two_halves.parts.push_back({core::Box{{1, 2, 1.5}}, {{0, 0, 1.5}, core::Quat::Identity()}});
  two_halves.parts.push_back({cuboid({1, 2, 1.5}, {0, 0, -1.5}), {Vec3::Zero(), core::Quat::Identity()}});
  expect_near(inertia_diagonal(two_halves, kMass), of_cuboid({1, 2, 3}, kMass), 0.01);
}

TEST(Inertia, OfATurnedPartIsTurned) {
  core::Compound turned;
  const core::Quat quarter(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()));
  turned.parts.push_back({core::Box{{1, 2, 3}}, {Vec3::Zero(), quarter}});
  expect_near(inertia_diagonal(turned, kMass), of_cuboid({1, 3, 2}, kMass));
}

TEST(Inertia, OfAFlatHullIsNotZero) {
  core::ConvexHull flat;
  flat.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_GT(inertia_diagonal(flat, kMass).minCoeff(), 0);
}

}  // namespace
}  // namespace aurasim::physics
