#include "cli/scene_warnings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/spatial_grid.h"
#include "physics/clearance.h"

namespace aurasim::cli {
namespace {

using core::Pose;
using core::Vec3;

constexpr std::size_t kMostOfAKind = 10;
/// Overlaps that are small against the bodies are how stacks are written down.
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

/// With its place, as messages begin.
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

/// The bodies of a scene, and its convex statics as if they were bodies, so that one can be measured against another.
class StartOfScene {
 public:
  explicit StartOfScene(const config::Launch& launch) : launch_(launch), scene_(launch.scene) {
    for (const core::StaticBody& body : scene_.statics) add_as_prototype(body);
    query_ = physics::make_clearance_query(scene_);
    for (const core::InitialBody& body : scene_.bodies) {
      largest_radius_ = std::max(largest_radius_, query_->bounding_radius(body.prototype));
    }
    grid_.clear(std::max(2 * largest_radius_, 1e-3));
    for (std::uint32_t i = 0; i < scene_.bodies.size(); ++i) grid_.add(i, scene_.bodies[i].pose.p_WB);
    grid_.build();
    for (const core::JointSpec& joint : scene_.joints) {
      if (joint.b && !joint.collide) joined_.insert(std::minmax(joint.a, *joint.b));
    }
  }

  void add_overlaps_of_bodies(OfAKind& overlaps) const {
    for (std::uint32_t i = 0; i < scene_.bodies.size(); ++i) {
      const core::InitialBody& a = scene_.bodies[i];
      std::vector<std::uint32_t> others;
      for_each_near(a.pose.p_WB, query_->bounding_radius(a.prototype), [&](std::uint32_t j) {
        if (j > i && !joined_.contains({a.id, scene_.bodies[j].id})) others.push_back(j);
      });
      std::ranges::sort(others);
      for (const std::uint32_t j : others) {
        const core::InitialBody& b = scene_.bodies[j];
        const double depth = depth_of(a.prototype, a.pose, b);
        if (depth > 0)
          overlaps.add(fmt::format("{} overlaps {} by {:.2g} m at the start", body_at_place(launch_, i),
                                   body_text(launch_, j), depth));
      }
    }
  }

  void add_overlaps_of_statics(OfAKind& overlaps) const {
    for (std::size_t s = 0; s < scene_.statics.size(); ++s) {
      const core::StaticBody& body = scene_.statics[s];
      const core::Shape& shape = scene_.shapes[body.shape].shape;
      if (const auto* plane = std::get_if<core::Plane>(&shape)) {
        add_overlaps_of_plane(body, *plane, overlaps);
      } else if (!std::holds_alternative<core::TriangleMesh>(shape)) {
        add_overlaps_of_static(body, static_prototypes_[s], overlaps);
      }
    }
  }

 private:
  void add_as_prototype(const core::StaticBody& body) {
    const core::Shape& shape = scene_.shapes[body.shape].shape;
    const bool convex =
        !std::holds_alternative<core::Plane>(shape) && !std::holds_alternative<core::TriangleMesh>(shape);
    static_prototypes_.push_back(core::PrototypeId{static_cast<std::uint32_t>(convex ? scene_.prototypes.size() : 0)});
    if (convex) scene_.prototypes.push_back({.name = body.name, .shape = body.shape, .material = body.material});
  }

  template <class Visit>
  void for_each_near(const Vec3& p, double radius, Visit&& visit) const {
    const Vec3 range = Vec3::Constant(radius + largest_radius_);
    grid_.for_each_in(p - range, p + range, visit);
  }

  /// How deep the two are in each other; 0 if that is nothing to speak of.
  double depth_of(core::PrototypeId a, const Pose& pose_a, const core::InitialBody& b) const {
    const double depth = -query_->clearance(a, pose_a, b.prototype, b.pose, 0);
    return depth > deep(b, query_->bounding_radius(a)) ? depth : 0;
  }

  double deep(const core::InitialBody& body, double other_radius) const {
    return kDeepShare * std::min(query_->bounding_radius(body.prototype), other_radius);
  }

  void add_overlaps_of_static(const core::StaticBody& body, core::PrototypeId prototype, OfAKind& overlaps) const {
    std::vector<std::uint32_t> near;
    for_each_near(body.pose.p_WB, query_->bounding_radius(prototype), [&](std::uint32_t i) { near.push_back(i); });
    std::ranges::sort(near);
    for (const std::uint32_t i : near) {
      const double depth = depth_of(prototype, body.pose, scene_.bodies[i]);
      if (depth > 0) {
        overlaps.add(fmt::format("{} is {:.2g} m deep in the static \"{}\" at the start", body_at_place(launch_, i),
                                 depth, body.name));
      }
    }
  }

  void add_overlaps_of_plane(const core::StaticBody& body, const core::Plane& plane, OfAKind& overlaps) const {
    const Vec3 normal_W = body.pose.q_WB * plane.normal;
    const double offset = plane.offset + body.pose.p_WB.dot(normal_W);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const core::InitialBody& one = scene_.bodies[i];
      const core::Shape& shape = scene_.shapes[scene_.prototypes[core::value_of(one.prototype)].shape].shape;
      const double height = one.pose.p_WB.dot(normal_W) - offset;
      const Vec3 d_B = one.pose.q_WB.conjugate() * -normal_W;
      const double depth = std::visit(ExtentAlong{d_B}, shape) - height;
      if (depth > deep(one, std::numeric_limits<double>::infinity())) {
        overlaps.add(fmt::format("{} is {:.2g} m {} the static \"{}\" at the start", body_at_place(launch_, i), depth,
                                 height < 0 ? "below the surface of" : "deep in", body.name));
      }
    }
  }

  const config::Launch& launch_;
  core::Scene scene_;
  std::unique_ptr<core::ClearanceQuery> query_;
  std::vector<core::PrototypeId> static_prototypes_;  ///< as scene_.statics; of those that are convex
  core::SpatialGrid grid_;
  double largest_radius_ = 0;
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

std::vector<std::string> scene_warnings(const config::Launch& launch) {
  OfAKind fast, overlaps, sunk;
  add_fast_bodies(launch, fast);
  add_fast_injectors(launch, fast);
  const StartOfScene start(launch);
  start.add_overlaps_of_bodies(overlaps);
  start.add_overlaps_of_statics(sunk);
  std::vector<std::string> all;
  fast.move_to(all, "that are too fast");
  overlaps.move_to(all, "overlaps of bodies");
  sunk.move_to(all, "bodies in statics");
  return all;
}

}  // namespace aurasim::cli
