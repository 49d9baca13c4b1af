#include "overseer/convex_hull.h"

#include <algorithm>
#include <set>
#include <utility>

namespace aurasim::overseer {
namespace {

using core::Vec3;
using Triangle = std::array<std::uint32_t, 3>;

class Hull {
 public:
  explicit Hull(const std::vector<Vec3>& points) : points_(points) {
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    size_ = (high - low).norm();
  }

  /// False if all points lie in a plane.
  bool begin() {
    const auto far = [&](auto&& distance) {
      std::uint32_t best = 0;
      for (std::uint32_t i = 1; i < points_.size(); ++i) {
        if (distance(points_[i]) > distance(points_[best])) best = i;
      }
      return best;
    };
    const std::uint32_t a = 0;
    const std::uint32_t b = far([&](const Vec3& p) { return (p - points_[a]).norm(); });
    const Vec3 along = (points_[b] - points_[a]).normalized();
    const std::uint32_t c = far([&](const Vec3& p) { return (p - points_[a]).cross(along).norm(); });
    const Vec3 normal = (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
    const std::uint32_t d = far([&](const Vec3& p) { return std::abs((p - points_[a]).dot(normal)); });
    if (!normal.allFinite() || std::abs((points_[d] - points_[a]).dot(normal)) <= tolerance()) return false;
    middle_ = (points_[a] + points_[b] + points_[c] + points_[d]) / 4;
    for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, b, d}, Triangle{a, c, d}, Triangle{b, c, d}}) add(t);
    return true;
  }

  void include(std::uint32_t point) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    const auto visible = [&](const Triangle& t) { return height(t, points_[point]) > tolerance(); };
    for (const Triangle& t : triangles_) {
      if (!visible(t)) continue;
      for (int i = 0; i < 3; ++i) edges.insert({t[i], t[(i + 1) % 3]});
    }
    std::erase_if(triangles_, visible);
    for (const auto& [from, to] : edges) {
      if (!edges.contains({to, from})) triangles_.push_back({from, to, point});  // the rim of what was visible
    }
  }

  std::vector<Triangle> take() { return std::move(triangles_); }

 private:
  double tolerance() const { return 1e-9 * size_; }
  double height(const Triangle& t, const Vec3& p) const {
    const Vec3 normal = (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
    const double length = normal.norm();
    return length > 0 ? normal.dot(p - points_[t[0]]) / length : 0;
  }
  void add(Triangle t) {
    if (height(t, middle_) > 0) std::swap(t[1], t[2]);
    triangles_.push_back(t);
  }

  const std::vector<Vec3>& points_;
  double size_ = 0;
  Vec3 middle_ = Vec3::Zero();
  std::vector<Triangle> triangles_;
};

}  // namespace

std::vector<Triangle> hull_triangles(const std::vector<Vec3>& points) {
  if (points.size() < 4) return {};
  Hull hull(points);
  if (!hull.begin()) return {};
  for (std::uint32_t i = 0; i < points.size(); ++i) hull.include(i);
  return hull.take();
}

}  // namespace aurasim::overseer
