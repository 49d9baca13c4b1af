// Bodies that are not convex, as convex parts.
#include "config/convex_parts.h"

#include <cmath>

#include <gtest/gtest.h>

#include "config/meshes.h"
#include "core/mesh_hash.h"

namespace aurasim::config {
namespace {

using core::TriangleMesh;
using core::Vec3;
using Quad = std::array<std::uint32_t, 4>;

void add(TriangleMesh& mesh, const Quad& q) {
  mesh.triangles.push_back({q[0], q[1], q[2]});
  mesh.triangles.push_back({q[0], q[2], q[3]});
}

/// Along y, 2 m long; 3 m wide, 2 m high, walls of 1 m and 0.5 m, open to the top: 3 x 0.5 + 2 x 1 x 1.5 = 4.5 m^2.
TriangleMesh channel() {
  const std::vector<std::pair<double, double>> outline = {{0, 0},   {3, 0},   {3, 2}, {2, 2},
                                                          {2, 0.5}, {1, 0.5}, {1, 2}, {0, 2}};
  TriangleMesh mesh;
  for (const double y : {0.0, 2.0}) {
    for (const auto& [x, z] : outline) mesh.points.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < 8; ++i) add(mesh, {i, i + 8, (i + 1) % 8 + 8, (i + 1) % 8});
  for (const Quad& q : {Quad{0, 1, 4, 5}, Quad{1, 2, 3, 4}, Quad{0, 5, 6, 7}}) {
    add(mesh, q);
    add(mesh, {q[3] + 8, q[2] + 8, q[1] + 8, q[0] + 8});
  }
  return mesh;
}

/// Of the pieces, m^3; negative for those whose triangles face inwards.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) sum += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]])) / 6;
  return sum;
}

TriangleMesh parts_of(const TriangleMesh& mesh) {
  auto parts = decompose(mesh);
  EXPECT_TRUE(std::holds_alternative<TriangleMesh>(parts));
  return std::get<TriangleMesh>(std::move(parts));
}

/// Outside if some triangle of the convex piece is between.
bool inside_a_part(const TriangleMesh& pieces, const Vec3& p) {
  const core::Compound compound = convex_parts(pieces);
  const Vec3 centre = centre_of_mass(pieces);
  for (const core::CompoundPart& part : compound.parts) {
    const auto& points = std::get<core::ConvexHull>(part.shape).points;
    bool inside = true;
    for (int i = 0; i < 2000 && inside; ++i) {  // directions all round
      const double z = 1 - (2 * i + 1) / 2000.0, turn = i * 2.399963229728653, r = std::sqrt(1 - z * z);
      const Vec3 d(r * std::cos(turn), r * std::sin(turn), z);
      double farthest = -1e9;
      for (const Vec3& q : points) farthest = std::max(farthest, d.dot(q));
      inside = d.dot(p - centre) <= farthest + 1e-9;
    }
    if (inside) return true;
  }
  return false;
}

TEST(ConvexParts, AHollowIsNotFilled) {
  ASSERT_NEAR(volume(channel()), 9.0, 1e-9);
  const TriangleMesh pieces = parts_of(channel());
  EXPECT_GE(convex_parts(pieces).parts.size(), 2U);
  EXPECT_NEAR(std::abs(volume(pieces)), 9.0, 1.0);
  EXPECT_FALSE(inside_a_part(pieces, {1.5, 1, 1.2}));
  for (const Vec3& p : {Vec3(0.5, 1, 1.5), Vec3(2.5, 1, 1.5), Vec3(1.5, 1, 0.25)})
    EXPECT_TRUE(inside_a_part(pieces, p));
}

TEST(ConvexParts, WhatIsConvexStaysWhole) {
  TriangleMesh box = channel();
  box.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  box.triangles.clear();
  for (const Quad& q :
       {Quad{3, 2, 1, 0}, Quad{4, 5, 6, 7}, Quad{0, 1, 5, 4}, Quad{1, 2, 6, 5}, Quad{2, 3, 7, 6}, Quad{3, 0, 4, 7}}) {
    add(box, q);
  }
  const core::Compound compound = convex_parts(parts_of(box));
  ASSERT_EQ(compound.parts.size(), 1U);
  for (const Vec3& p : std::get<core::ConvexHull>(compound.parts[0].shape).points) {
    EXPECT_NEAR(p.cwiseAbs().maxCoeff(), 0.5, 1e-6);
  }
}

TriangleMesh tetrahedron(const Vec3& corner) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) mesh.points.push_back(p + corner);
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

TEST(ConvexParts, ATetrahedronEnclosesSomething) {
  EXPECT_NEAR(volume(parts_of(tetrahedron({5, 0, 0}))), 1.0 / 6, 1e-9);
}

TEST(ConvexParts, TwoTetrahedraInOneMeshAreTwoParts) {
  TriangleMesh two = tetrahedron({0, 0, 0});
  const TriangleMesh other = tetrahedron({5, 0, 0});
  two.points.insert(two.points.end(), other.points.begin(), other.points.end());
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
  const TriangleMesh parts = parts_of(two);
  EXPECT_EQ(convex_parts(parts).parts.size(), 2U);
  EXPECT_FALSE(inside_a_part(parts, {3, 0.1, 0.1}));
  EXPECT_TRUE(inside_a_part(parts, {5.1, 0.1, 0.1}));
}

/// HACD's own hull of a pyramid loses a corner of its base.
TEST(ConvexParts, NoCornerIsLost) {
  TriangleMesh pyramid;
  pyramid.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
  add(pyramid, {3, 2, 1, 0});
  for (std::uint32_t i = 0; i < 4; ++i) pyramid.triangles.push_back({i, (i + 1) % 4, 4});
  EXPECT_NEAR(volume(parts_of(pyramid)), 1.0 / 3, 1e-9);
}

TEST(ConvexParts, AMeshWhoseTrianglesFaceInwardsIsTurned) {
  TriangleMesh inside_out = tetrahedron({0, 0, 0});
  for (auto& t : inside_out.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(volume(parts_of(inside_out)), 1.0 / 6, 1e-9);
}

TEST(ConvexParts, AreTheSameEveryTime) {
  const TriangleMesh once = parts_of(channel()), again = parts_of(channel());
  EXPECT_EQ(core::content_hash(once), core::content_hash(again));
}

TEST(ConvexParts, OfTooManyTrianglesAreNotLookedFor) {
  TriangleMesh mesh = channel();
  while (mesh.triangles.size() <= 4000) mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {1, 2, 3}});
  const auto parts = decompose(mesh);
  ASSERT_TRUE(std::holds_alternative<std::string>(parts));
  EXPECT_NE(std::get<std::string>(parts).find("at most 4000"), std::string::npos);
}

}  // namespace
}  // namespace aurasim::config
