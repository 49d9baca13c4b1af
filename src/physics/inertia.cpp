#include "physics/inertia.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <LinearMath/btConvexHullComputer.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

using core::Mat3;
using core::Vec3;
using std::numbers::pi;

/// Integrals of 1, r and r r^T over a solid, about the origin of its frame: m^3, m^4, m^5.
struct Moments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
};

Moments centred(double volume, const Vec3& mean_squares) {
  return {volume, Vec3::Zero(), Mat3((volume * mean_squares).asDiagonal())};
}

Moments moments(const core::Sphere& s) {
  return centred(4.0 / 3 * pi * std::pow(s.radius, 3), Vec3::Constant(s.radius * s.radius / 5));
}

Moments moments(const core::Box& s) { return centred(8 * s.half_extents.prod(), s.half_extents.cwiseAbs2() / 3); }

Moments moments(const core::Cylinder& s) {
  const double across = s.radius * s.radius / 4;
  return centred(pi * s.radius * s.radius * s.height, Vec3(across, across, s.height * s.height / 12));
}

/// Moments of a capsule: a cylinder and two half spheres, each with its centre of mass 3/8 r beyond the cylinder's end.
Moments moments(const core::Capsule& s) {
  const double r = s.radius;
  const double half = s.height / 2;
  Moments result = moments(core::Cylinder{r, s.height});
  const double caps = 4.0 / 3 * pi * r * r * r;
  const double along = half * half + 2 * half * 3.0 / 8 * r + r * r / 5;
  result.volume += caps;
  result.second += Mat3((caps * Vec3(r * r / 5, r * r / 5, along)).asDiagonal());
  return result;
}

/// Moments of the tetrahedron with corners a, b, c and the origin. Negative if a, b, c turn clockwise as seen from
/// outside.
Moments moments_of_tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double volume = a.dot(b.cross(c)) / 6;
  const Vec3 sum = a + b + c;
  const Mat3 squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
  return {volume, volume / 4 * sum, volume / 20 * squares};
}

void add(Moments& to, const Moments& m, double factor = 1) {
  to.volume += factor * m.volume;
  to.first += factor * m.first;
  to.second += factor * m.second;
}

Moments moments(const core::ConvexHull& s) {
  Moments sum;
  if (s.points.size() < 4) return sum;
  btConvexHullComputer hull;
  hull.compute(s.points.front().data(), sizeof(Vec3), static_cast<int>(s.points.size()), 0, 0);
  const auto vertex = [&](int index) { return from_bullet(hull.vertices[index]); };
  for (int face = 0; face < hull.faces.size(); ++face) {
    const btConvexHullComputer::Edge* const first = &hull.edges[hull.faces[face]];
    const Vec3 corner = vertex(first->getSourceVertex());
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != first->getSourceVertex();
         edge = edge->getNextEdgeOfFace()) {
      add(sum, moments_of_tetrahedron(corner, vertex(edge->getSourceVertex()), vertex(edge->getTargetVertex())));
    }
  }
  Moments result;
  add(result, sum, sum.volume < 0 ? -1 : 1);
  return result;
}

Moments moved(const Moments& m, const core::Pose& pose) {
  const Mat3 rotation = pose.q_WB.normalized().toRotationMatrix();
  const Vec3& d = pose.p_WB;
  const Vec3 first = rotation * m.first;
  Moments result{m.volume, first + m.volume * d, rotation * m.second * rotation.transpose()};
  result.second += d * first.transpose() + first * d.transpose() + m.volume * d * d.transpose();
  return result;
}

Moments moments(const core::Compound& s) {
  Moments sum;
  for (const core::CompoundPart& part : s.parts) {
    add(sum, moved(std::visit([](const auto& shape) { return moments(shape); }, part.shape), part.pose));
  }
  return sum;
}

Moments moments(const core::TriangleMesh&) { throw std::invalid_argument("a triangle mesh cannot be a moving body"); }
Moments moments(const core::Plane&) { throw std::invalid_argument("a plane cannot be a moving body"); }

}  // namespace

Vec3 inertia_diagonal(const core::Shape& shape, double mass_kg) {
  Moments m = std::visit([](const auto& s) { return moments(s); }, shape);
  if (!(m.volume > 0)) m = moments(core::Sphere{core::bounding_radius(shape)});
  const Vec3 squares = m.second.diagonal();
  return mass_kg / m.volume * (Vec3::Constant(squares.sum()) - squares);
}

core::Vec3 inertia_of(const core::Prototype& prototype, const core::Scene& scene) {
  const Vec3 spread = inertia_diagonal(scene.shapes.at(prototype.shape).shape, prototype.mass_kg);  // or throws
  return prototype.inertia.value_or(spread);
}

}  // namespace aurasim::physics
