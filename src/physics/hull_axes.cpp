#include "physics/hull_axes.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

using Kind = HullAxis::Kind;

constexpr double kNothing = -std::numeric_limits<double>::infinity();
/// Axes whose gaps differ by less than this share of the margin count as equal.
constexpr double kPrefer = 1.0 / 40;
/// Bodies that stay apart by less may touch, m: Bullet's casts are as exact.
constexpr double kApart_m = 0.001;
/// Edges whose angle has a smaller sine squared count as parallel. Faces then give the axis.
constexpr double kParallel = 1e-8;
/// Bound of rounding errors, as a share of the hulls' sizes.
constexpr double kRounding = 1e-9;
/// Points of B - A that are remembered for the search for edges.
constexpr std::size_t kMostWitnesses = 16;

/// The faces of one of the hulls, as far as the search knows them.
struct Faces {
  std::vector<double> bounds;          ///< upper bound of each gap; kNothing once the face has been searched
  std::vector<double> products;        ///< of each remembered point of B - A with each normal
  std::vector<std::uint32_t> refuted;  ///< by face: bits of the points that show that it cannot be best
  double best = kNothing;
  std::uint32_t face = 0;
  std::size_t highest = 0;  ///< face with the highest bound
};

/// An edge in A's frame, with the normals of its faces; those of B are turned round.
struct EdgeInA {
  std::uint32_t number;
  btVector3 from, along, left, right;
};

/// Memory of one thread, kept between calls.
struct Space {
  Faces a, b;
  std::vector<EdgeInA> edges_of_a, edges_of_b;
};

Space& space_of_this_thread() {
  thread_local Space space;
  return space;
}

struct EdgeGap {
  double gap = kNothing;
  btVector3 normal{0, 0, 0};
};
/// The gap across two edges; kNothing if no point of them can be closest. Their arcs on the Gauss map have to cross:
/// D. Gregorius, The Separating Axis Test between Convex Polyhedra (2013).
EdgeGap across(const EdgeInA& a, const EdgeInA& b) {
  const btScalar left_b = b.left.dot(a.along), right_b = b.right.dot(a.along);
  if (!(left_b * right_b < 0)) return {};
  const btScalar left_a = a.left.dot(b.along), right_a = a.right.dot(b.along);
  if (!(left_a * right_a < 0) || !(left_b * right_a > 0)) return {};
  btVector3 normal = a.along.cross(b.along);
  const btScalar length2 = normal.length2();
  if (!(length2 > kParallel * a.along.length2() * b.along.length2())) return {};
  normal /= btSqrt(length2);
  if (normal.dot(a.left + a.right) < 0) normal = -normal;
  return {normal.dot(b.from - a.from), normal};
}

void begin(Faces& faces, const HullFaces& hull) {
  faces.bounds.assign(hull.normals.padded_size(), kNothing);
  std::fill_n(faces.bounds.begin(), hull.face_count(), std::numeric_limits<double>::infinity());
  faces.products.resize(kMostWitnesses * hull.normals.padded_size());
  faces.best = kNothing;
  faces.face = 0;
}

/// Marks for each face those of the `known` points that refute gaps above `limit`.
void refute(Faces& faces, const HullFaces& hull, std::size_t known, double limit) {
  faces.refuted.assign(hull.face_count(), 0);
  for (std::size_t k = 0; k < known; ++k) {
    const double* const products = &faces.products[k * hull.normals.padded_size()];
    for (std::size_t i = 0; i < hull.face_count(); ++i) {
      faces.refuted[i] |= static_cast<std::uint32_t>(products[i] <= limit) << k;
    }
  }
}

class Search {
 public:
  Search(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, double margin_m)
      : a_(a),
        b_(b),
        R_(X_AB.getBasis()),
        p_(X_AB.getOrigin()),
        margin_(margin_m),
        prefer_(margin_m * kPrefer),
        rounding_((a.size + b.size) * kRounding),
        space_(space_of_this_thread()) {}

  std::optional<HullGap> run(HullAxis& last) {
    if (is_apart_along(last)) return std::nullopt;
    begin(space_.a, a_), begin(space_.b, b_);
    if (!look_at_faces(last)) return std::nullopt;
    const Faces &of_a = space_.a, &of_b = space_.b;
    if (of_a.best == kNothing && of_b.best == kNothing) return std::nullopt;  // the pose is not finite
    HullGap found;
    if (of_b.best > of_a.best + prefer_) {
      found = {{Kind::kFaceOfB, 0, of_b.face}, -(R_ * b_.normals[of_b.face]), of_b.best};
    } else {
      found = {{Kind::kFaceOfA, of_a.face, 0}, a_.normals[of_a.face], of_a.best};
    }
    last = found.axis;
    if (!is_deep() && !look_at_edges(found, last)) return std::nullopt;
    return found;
  }

  bool stays_apart(const btVector3& way) {
    begin(space_.a, a_), begin(space_.b, b_);
    const btVector3 middle = R_ * b_.centre + p_ - a_.centre + way / 2;
    take_both(nearest_along(middle), way);
    while (true) {
      const bool of_a = space_.a.bounds[space_.a.highest] >= space_.b.bounds[space_.b.highest];
      Faces& faces = of_a ? space_.a : space_.b;
      const auto face = static_cast<std::uint32_t>(faces.highest);
      if (!(faces.bounds[face] > kApart_m)) return false;
      const FaceGap found = of_a ? face_of_a(face) : face_of_b(face);
      const btVector3 normal = of_a ? a_.normals[face] : -(R_ * b_.normals[face]);
      if (std::min(found.gap, found.gap + normal.dot(way)) > kApart_m) return true;
      faces.bounds[face] = kNothing;
      take_both(found.witness, way);
    }
  }

 private:
  struct FaceGap {
    double gap;
    btVector3 witness;  ///< the point of B - A that is nearest along the normal
  };

  FaceGap face_of_a(std::uint32_t face) const {
    const btVector3 normal = a_.normals[face], in_b = normal * R_;
    const btVector3 point = b_.corners[b_.corners.farthest(-in_b)];
    return {in_b.dot(point) + normal.dot(p_) - a_.offsets[face],
            R_ * point + p_ - a_.corners[a_.loop_corners[a_.face_begin[face]]]};
  }

  FaceGap face_of_b(std::uint32_t face) const {
    const btVector3 normal = R_ * b_.normals[face];
    const btVector3 point = a_.corners[a_.corners.farthest(-normal)];
    return {normal.dot(point) - normal.dot(p_) - b_.offsets[face],
            R_ * b_.corners[b_.loop_corners[b_.face_begin[face]]] + p_ - point};
  }

  EdgeInA edge_of_a(std::uint32_t number) const {
    const HullFaces::Edge& edge = a_.edges[number];
    return {number, a_.corners[edge.from], a_.along(edge), a_.normals[edge.left], a_.normals[edge.right]};
  }
  EdgeInA edge_of_b(std::uint32_t number) const {
    const HullFaces::Edge& edge = b_.edges[number];
    return {number, R_ * b_.corners[edge.from] + p_, R_ * b_.along(edge), -(R_ * b_.normals[edge.left]),
            -(R_ * b_.normals[edge.right])};
  }

  bool is_apart_along(const HullAxis& last) const {
    if (last.kind == Kind::kFaceOfA) return face_of_a(last.of_a).gap > margin_;
    if (last.kind == Kind::kFaceOfB) return face_of_b(last.of_b).gap > margin_;
    return last.kind == Kind::kEdges && across(edge_of_a(last.of_a), edge_of_b(last.of_b)).gap > margin_;
  }

  /// Balls inside the hulls overlap by half, so there is no gap along any axis.
  bool is_deep() const {
    const double depth = (a_.inner_radius + b_.inner_radius) / 2;
    return (R_ * b_.centre + p_ - a_.centre).length2() < depth * depth;
  }

  void tighten(Faces& faces, const HullFaces& hull, const btVector3& witness) {
    const double w[3] = {witness.x(), witness.y(), witness.z()};
    const PointLanes& n = hull.normals;
    const std::size_t place = std::min(witnesses_, kMostWitnesses - 1) * n.padded_size();
    faces.highest =
        soft::kernel().tighten(n.x(), n.y(), n.z(), n.padded_size(), w, &faces.products[place], faces.bounds.data());
  }

  /// `witness`: any point of B - A.
  void take(const btVector3& witness) {
    tighten(space_.a, a_, witness);
    tighten(space_.b, b_, -(witness * R_));
    ++witnesses_;
  }

  /// Takes a point of B - A at the start and at the end of a motion.
  void take_both(const btVector3& witness, const btVector3& way) { take(witness), take(witness + way); }

  /// The point of B - A that is nearest along an axis from A to B.
  btVector3 nearest_along(const btVector3& axis) const {
    return R_ * b_.corners[b_.corners.farthest(-(axis * R_))] + p_ - a_.corners[a_.corners.farthest(axis)];
  }

  /// False if the hulls are apart along the face.
  bool search(bool of_a, std::uint32_t face) {
    Faces& faces = of_a ? space_.a : space_.b;
    const FaceGap found = of_a ? face_of_a(face) : face_of_b(face);
    if (found.gap > faces.best || (found.gap == faces.best && face < faces.face)) {
      faces.best = found.gap, faces.face = face;
    }
    faces.bounds[face] = kNothing;
    take(found.witness);
    return !(found.gap > margin_);
  }

  /// Searches the faces that can be best, most promising first. False if the hulls are apart along one of them.
  bool look_at_faces(HullAxis& last) {
    if (last.kind == Kind::kFaceOfA || last.kind == Kind::kFaceOfB) {
      const bool of_a = last.kind == Kind::kFaceOfA;
      search(of_a, of_a ? last.of_a : last.of_b);
    } else {
      take(nearest_along(R_ * b_.centre + p_ - a_.centre));
    }
    while (true) {
      const double bound_a = space_.a.bounds[space_.a.highest], bound_b = space_.b.bounds[space_.b.highest];
      const double wanted = std::max(space_.a.best, space_.b.best) - prefer_ - rounding_;
      if (std::max(bound_a, bound_b) < wanted || std::max(bound_a, bound_b) == kNothing) return true;
      const bool of_a = bound_a >= bound_b;
      const auto face = static_cast<std::uint32_t>(of_a ? space_.a.highest : space_.b.highest);
      if (search(of_a, face)) continue;
      last = of_a ? HullAxis{Kind::kFaceOfA, face, 0} : HullAxis{Kind::kFaceOfB, 0, face};
      return false;
    }
  }

  /// Searches pairs of edges that can be better than the best face. False if the hulls are apart along one of them. A
  /// point that refutes both faces of an edge refutes all normals between them.
  bool look_at_edges(HullGap& found, HullAxis& last) {
    const double faces = std::max(space_.a.best, space_.b.best);
    const double limit = std::min(faces + prefer_, 0.0) - rounding_;
    const std::size_t known = std::min(witnesses_, kMostWitnesses);
    refute(space_.a, a_, known, limit), refute(space_.b, b_, known, limit);
    const auto collect = [](std::vector<EdgeInA>& edges, const HullFaces& hull, const Faces& of_hull, auto&& in_a) {
      edges.clear();
      for (std::uint32_t i = 0; i < hull.edges.size(); ++i) {
        if ((of_hull.refuted[hull.edges[i].left] & of_hull.refuted[hull.edges[i].right]) == 0) edges.push_back(in_a(i));
      }
    };
    collect(space_.edges_of_a, a_, space_.a, [this](std::uint32_t i) { return edge_of_a(i); });
    collect(space_.edges_of_b, b_, space_.b, [this](std::uint32_t i) { return edge_of_b(i); });
    double best = faces + prefer_;
    for (const EdgeInA& a : space_.edges_of_a) {
      for (const EdgeInA& b : space_.edges_of_b) {
        const EdgeGap gap = across(a, b);
        if (gap.gap > margin_) {
          last = {Kind::kEdges, a.number, b.number};
          return false;
        }
        if (!(gap.gap > best)) continue;
        best = gap.gap;
        found = {{Kind::kEdges, a.number, b.number}, gap.normal, gap.gap};
        last = found.axis;
      }
    }
    return true;
  }

  const HullFaces &a_, &b_;
  const btMatrix3x3& R_;
  const btVector3& p_;
  const double margin_, prefer_, rounding_;
  Space& space_;
  std::size_t witnesses_ = 0;
};

}  // namespace

std::optional<HullGap> closest_axis(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, double margin_m,
                                    HullAxis& last) {
  return Search(a, b, X_AB, margin_m).run(last);
}

bool stay_apart(const HullFaces& a, const HullFaces& b, const btTransform& X_AB, const btVector3& way) {
  return Search(a, b, X_AB, 0).stays_apart(way);
}

}  // namespace aurasim::physics
