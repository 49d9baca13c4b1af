#include "setup/scene_warnings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/box_tree.h"
#include "physics/clearance.h"

namespace aurasim::setup {
namespace {

using core::Pose;
using core::Vec3;

constexpr std::size_t kMostOfAKind = 10;
/// Share of the size below which an overlap is not reported: scenes often write stacks with small overlaps.
constexpr double kDeepShare = 0.05;

std::string place_of(const config::Launch& launch, const std::vector<config::SceneSource>& sources, std::size_t i) {
  const std::string file = launch.scene_file.string();
  if (i >= sources.size() || sources[i].line == 0) return file;
  return fmt::format("{}:{}:{}", file, sources[i].line, sources[i].column);
}

/// `body 3 ("thrown")`.
std::string body_text(const config::Launch& launch, std::size_t i) {
  const bool has_name = i < launch.body_sources.size() && !launch.body_sources[i].name.empty();
  const std::string name = has_name ? fmt::format(" (\"{}\")", launch.body_sources[i].name) : "";
  return fmt::format("body {}{}", core::value_of(launch.scene.bodies[i].id), name);
}

/// The body with its place in the file, as messages begin.
std::string body_at_place(const config::Launch& launch, std::size_t i) {
  return fmt::format("{}: {}", place_of(launch, launch.body_sources, i), body_text(launch, i));
}

/// Farthest point of a shape in direction `d`, measured along it from the origin of the shape's frame.
struct ExtentAlong {
  const Vec3& d;

  double operator()(const core::Sphere& s) const { return s.radius; }
  double operator()(const core::Box& s) const { return s.half_extents.dot(d.cwiseAbs()); }
  double operator()(const core::Capsule& s) const { return s.radius + s.height / 2 * std::abs(d.z()); }
  double operator()(const core::Cylinder& s) const {
    return s.radius * std::hypot(d.x(), d.y()) + s.height / 2 * std::abs(d.z());
  }
  double operator()(const core::ConvexHull& s) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : s.points) most = std::max(most, p.dot(d));
    return most;
  }
  double operator()(const core::Compound& s) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const core::CompoundPart& part : s.parts) {
      const Vec3 d_P = part.pose.q_WB.conjugate() * d;
      most = std::max(most, part.pose.p_WB.dot(d) + std::visit(ExtentAlong{d_P}, part.shape));
    }
    return most;
  }
  double operator()(const core::TriangleMesh&) const { return 0; }
  double operator()(const core::Plane&) const { return 0; }
};

/// Collects warnings of one kind; beyond a limit it counts them only.
class OfAKind {
 public:
  void add(std::string text) {
    if (++count_ <= kMostOfAKind) texts_.push_back(std::move(text));
  }

  void move_to(std::vector<std::string>& all, std::string_view what) {
    std::ranges::move(texts_, std::back_inserter(all));
    if (count_ > kMostOfAKind) all.push_back(fmt::format("and {} more {}", count_ - kMostOfAKind, what));
  }

 private:
  std::vector<std::string> texts_;
  std::size_t count_ = 0;
};

core::BoxTree::Box box_around(const core::Shape& shape, const Pose& pose) {
  core::BoxTree::Box box{pose.p_WB, pose.p_WB};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d_B = pose.q_WB.conjugate() * Vec3::Unit(axis);
    const Vec3 opposite_B = -d_B;
    box.high[axis] += std::visit(ExtentAlong{d_B}, shape);
    box.low[axis] -= std::visit(ExtentAlong{opposite_B}, shape);
  }
  return box;
}

/// The bodies of a scene, and its convex statics as if they were bodies, so that one can be measured against another.
class StartOfScene {
 public:
  explicit StartOfScene(const config::Launch& launch)
      : launch_(launch),
        scene_(launch.scene),
        bodies_(boxes_of_bodies()),
        statics_(boxes_of_statics()),
        overlapping_(scene_.bodies.size()) {
    query_ = physics::make_clearance_query(scene_);
    for (const core::JointSpec& joint : scene_.joints) {
      if (joint.b && !joint.collide) joined_.insert(std::minmax(joint.a, *joint.b));
    }
  }

  /// Adds a warning that the body overlaps another one, unless a warning names it already. To be called for all bodies
  /// in their order.
  void add_overlap_of_body(std::uint32_t i, OfAKind& overlaps) {
    if (overlapping_[i]) return;
    const core::InitialBody& a = scene_.bodies[i];
    bodies_.any(bodies_[i], [&](std::uint32_t j) {
      const core::InitialBody& b = scene_.bodies[j];
      if (i == j || joined_.contains(std::minmax(a.id, b.id))) return false;
      const double depth = depth_of(a.prototype, a.pose, b);
      if (depth <= 0) return false;
      overlapping_[i] = overlapping_[j] = true;
      overlaps.add(fmt::format("{} overlaps {} by {:.2g} m at the start", body_at_place(launch_, i),
                               body_text(launch_, j), depth));
      return true;
    });
  }

  std::size_t overlapping() const {
    return static_cast<std::size_t>(std::count(overlapping_.begin(), overlapping_.end(), true));
  }

  /// Adds a warning that the body overlaps a static; at most one for each body.
  void add_overlap_with_static(std::uint32_t i, OfAKind& overlaps) const {
    for (const std::uint32_t plane : planes_) {
      if (add_overlap_with_plane(i, scene_.statics[plane], overlaps)) return;
    }
    const core::InitialBody& one = scene_.bodies[i];
    statics_.any(bodies_[i], [&](std::uint32_t at) {
      const std::uint32_t other = convex_statics_[at];
      const double depth = depth_of(prototypes_.at(scene_.statics.shape(other)), scene_.statics.pose(other), one);
      if (depth <= 0) return false;
      overlaps.add(fmt::format("{} is {:.2g} m deep in the static \"{}\" at the start", body_at_place(launch_, i),
                               depth, scene_.statics[other].name));
      return true;
    });
  }

 private:
  const core::Shape& shape_of(const core::InitialBody& body) const {
    return scene_.shapes[scene_.prototypes[core::value_of(body.prototype)].shape].shape;
  }
  std::vector<core::BoxTree::Box> boxes_of_bodies() const {
    std::vector<core::BoxTree::Box> boxes;
    for (const core::InitialBody& body : scene_.bodies) boxes.push_back(box_around(shape_of(body), body.pose));
    return boxes;
  }

  std::vector<core::BoxTree::Box> boxes_of_statics() {
    std::vector<core::BoxTree::Box> boxes;
    for (std::uint32_t i = 0; i < scene_.statics.size(); ++i) {
      const std::uint32_t of = scene_.statics.shape(i);
      const core::Shape& shape = scene_.shapes[of].shape;
      if (std::holds_alternative<core::Plane>(shape)) {
        planes_.push_back(i);
      } else if (!std::holds_alternative<core::TriangleMesh>(shape)) {
        const core::PrototypeId next{static_cast<std::uint32_t>(scene_.prototypes.size())};
        if (prototypes_.emplace(of, next).second) scene_.prototypes.push_back({.name = "static", .shape = of});
        convex_statics_.push_back(i);
        boxes.push_back(box_around(shape, scene_.statics.pose(i)));
      }
    }
    return boxes;
  }

  /// How deep the two overlap, metres; 0 if the overlap is too small to report.
  double depth_of(core::PrototypeId a, const Pose& pose_a, const core::InitialBody& b) const {
    const double depth = -query_->clearance(a, pose_a, b.prototype, b.pose, 0);
    return depth > deep(b, query_->bounding_radius(a)) ? depth : 0;
  }

  double deep(const core::InitialBody& body, double other_radius) const {
    return kDeepShare * std::min(query_->bounding_radius(body.prototype), other_radius);
  }

  bool add_overlap_with_plane(std::uint32_t i, const core::StaticBody& body, OfAKind& overlaps) const {
    const auto& plane = std::get<core::Plane>(scene_.shapes[body.shape].shape);
    const Vec3 normal_W = body.pose.q_WB * plane.normal;
    const double offset = plane.offset + body.pose.p_WB.dot(normal_W);
    const core::InitialBody& one = scene_.bodies[i];
    const double height = one.pose.p_WB.dot(normal_W) - offset;
    const Vec3 d_B = one.pose.q_WB.conjugate() * -normal_W;
    const double depth = std::visit(ExtentAlong{d_B}, shape_of(one)) - height;
    if (depth <= deep(one, std::numeric_limits<double>::infinity())) return false;
    overlaps.add(fmt::format("{} is {:.2g} m {} the static \"{}\" at the start", body_at_place(launch_, i), depth,
                             height < 0 ? "below the surface of" : "deep in", body.name));
    return true;
  }

  const config::Launch& launch_;
  core::Scene scene_;
  std::vector<std::uint32_t> planes_, convex_statics_;     ///< statics
  std::map<std::uint32_t, core::PrototypeId> prototypes_;  ///< of bodies with the shapes of convex statics, by shape
  core::BoxTree bodies_, statics_;
  std::vector<bool> overlapping_;  ///< bodies that are named in a warning, or counted beyond the limit
  std::unique_ptr<core::ClearanceQuery> query_;
  std::set<std::pair<core::BodyId, core::BodyId>> joined_;
};

std::string too_fast(const config::Launch& launch, double speed_m_s) {
  return fmt::format("{:.4g} m/s, and tolerances.speed is {:.4g} m/s: its collisions may come late or be missed",
                     speed_m_s, launch.tolerances.speed_m_s);
}

void add_fast_bodies(const config::Launch& launch, OfAKind& fast) {
  for (std::size_t i = 0; i < launch.scene.bodies.size(); ++i) {
    const double speed_m_s = launch.scene.bodies[i].v_WB.norm();
    if (speed_m_s <= launch.tolerances.speed_m_s) continue;
    fast.add(fmt::format("{} starts with {}", body_at_place(launch, i), too_fast(launch, speed_m_s)));
  }
}

void add_fast_injectors(const config::Launch& launch, OfAKind& fast) {
  for (std::size_t i = 0; i < launch.scene.injectors.size(); ++i) {
    const core::Injector& injector = launch.scene.injectors[i];
    const double speed_m_s = injector.velocity_min.cwiseAbs().cwiseMax(injector.velocity_max.cwiseAbs()).norm();
    if (speed_m_s <= launch.tolerances.speed_m_s) continue;
    fast.add(fmt::format("{}: injector \"{}\" may throw with {}", place_of(launch, launch.injector_sources, i),
                         injector.name, too_fast(launch, speed_m_s)));
  }
}

}  // namespace

std::vector<std::string> scene_warnings(const config::Launch& launch, const std::function<void(double)>& reached) {
  constexpr std::uint32_t kToldEvery = 64;
  OfAKind fast, overlaps, sunk;
  add_fast_bodies(launch, fast);
  add_fast_injectors(launch, fast);
  StartOfScene start(launch);
  const auto bodies = static_cast<std::uint32_t>(launch.scene.bodies.size());
  for (std::uint32_t i = 0; i < bodies; ++i) {
    start.add_overlap_of_body(i, overlaps);
    start.add_overlap_with_static(i, sunk);
    if (reached && i % kToldEvery == 0) reached(static_cast<double>(i) / bodies);
  }
  std::vector<std::string> all;
  fast.move_to(all, "that are too fast");
  overlaps.move_to(all, fmt::format("such overlaps; {} of {} bodies overlap another one", start.overlapping(), bodies));
  sunk.move_to(all, "bodies in statics");
  return all;
}

}  // namespace aurasim::setup
