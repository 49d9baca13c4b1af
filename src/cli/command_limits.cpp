#include "cli/command_limits.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/launch_setup.h"
#include "config/launch_variants.h"

namespace aurasim::cli {
namespace {

constexpr std::uint64_t kMostBodies = 100'000;
constexpr std::size_t kMostStatics = 10'000;
constexpr std::size_t kMostKinds = 10'000;
constexpr std::size_t kMostTriangles = 200'000;
constexpr double kSmallest_m = 0.01;
constexpr double kLargest_m = 200;
constexpr double kLightest_kg = 1e-3;
constexpr double kHeaviest_kg = 1e6;
constexpr double kFarthest_m = 1e6;
constexpr double kHardest_Ns = 1e7;
constexpr double kFastestRate = 10;

std::string problem_with_place(const core::Vec3& p) {
  const bool sane = p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest_m;
  return sane ? std::string() : fmt::format("too far out, allowed: {} m", kFarthest_m);
}

std::string problem_with_speed(const core::Vec3& v, const config::Launch& launch) {
  const double limit_m_s = launch.tolerances.speed_m_s;
  if (v.norm() <= limit_m_s) return {};
  return fmt::format("{:.4g} m/s is faster than this run promises: tolerances.speed is {:.4g} m/s", v.norm(),
                     limit_m_s);
}

/// A body larger than any other reaches regions that do not listen to each other.
std::string problem_with_radius(double radius_m, const config::Launch& launch) {
  const double now_m = listening_distance_m(launch);
  double known_m = 0;
  for (const core::Prototype& prototype : launch.scene.prototypes) {
    known_m = std::max(known_m, core::bounding_radius(launch.scene.shapes[prototype.shape].shape));
  }
  const double needed_m = now_m + 2 * std::max(0.0, radius_m - known_m);
  for (std::uint32_t r = 0; r < launch.regions.size(); ++r) {
    const core::RegionId region{r};
    if (launch.regions.neighbours(region, needed_m) == launch.regions.neighbours(region, now_m)) continue;
    return fmt::format("a body with a radius of {:.4g} m is too large for these regions; the scene's largest: {:.4g} m",
                       radius_m, known_m);
  }
  return {};
}

std::string problem_with_shape(const core::Shape& shape, bool moves, const config::Launch& launch) {
  if (const auto* mesh = std::get_if<core::TriangleMesh>(&shape)) {
    if (moves) return "a mesh of triangles cannot move; use its hull";
    if (mesh->triangles.size() > kMostTriangles) {
      return fmt::format("the mesh has {} triangles, allowed: {}", mesh->triangles.size(), kMostTriangles);
    }
  }
  const double radius_m = core::bounding_radius(shape);
  if (!(radius_m >= kSmallest_m && radius_m <= kLargest_m)) {
    return fmt::format("its radius is {:.4g} m, allowed: {} to {} m", radius_m, kSmallest_m, kLargest_m);
  }
  return moves ? problem_with_radius(radius_m, launch) : std::string();
}

template <class Change>
std::string problem_with_change(Change&& change) {
  try {
    change();
  } catch (const config::BadConfig& error) {
    return error.errors().empty() ? std::string(error.what()) : error.errors().front();
  }
  return {};
}

std::string first_of(std::initializer_list<std::string> problems) {
  for (const std::string& problem : problems) {
    if (!problem.empty()) return problem;
  }
  return {};
}

struct Problem {
  const CommandContext& c;

  std::string operator()(const core::NewBody& ask) const {
    if (c.bodies >= kMostBodies) return fmt::format("there are {} bodies, allowed: {}", c.bodies, kMostBodies);
    const std::string where = first_of({problem_with_place(ask.pose.p_WB), problem_with_speed(ask.v_WB, c.launch)});
    if (!where.empty()) return where;
    if (!ask.shape) {
      const bool known =
          std::ranges::find(c.scene.prototypes, ask.prototype, &core::Prototype::name) != c.scene.prototypes.end();
      return known ? std::string() : fmt::format("the scene has no prototype \"{}\"", ask.prototype);
    }
    if (!(ask.mass_kg >= kLightest_kg && ask.mass_kg <= kHeaviest_kg)) {
      return fmt::format("its mass is {:.4g} kg, allowed: {} to {} kg", ask.mass_kg, kLightest_kg, kHeaviest_kg);
    }
    if (c.scene.prototypes.size() >= kMostKinds) return "there are too many kinds of bodies already";
    return c.shape ? problem_with_shape(*c.shape, true, c.launch) : "nobody knows its shape";
  }
  std::string operator()(const core::NewStatic& ask) const {
    if (c.scene.statics.size() >= kMostStatics) return fmt::format("there are {} statics already", kMostStatics);
    if (const std::string where = problem_with_place(ask.pose.p_WB); !where.empty()) return where;
    return c.shape ? problem_with_shape(*c.shape, false, c.launch) : "nobody knows its shape";
  }
  std::string operator()(const core::RemoveBody&) const { return {}; }
  std::string operator()(const core::RemoveStatic& ask) const {
    const bool known = core::value_of(ask.id) < c.scene.statics.size();
    return known ? std::string() : fmt::format("there is no static {}", core::value_of(ask.id));
  }
  std::string operator()(const core::Impulse& ask) const {
    if (!(ask.J_W.norm() <= kHardest_Ns)) return fmt::format("harder than {} N s", kHardest_Ns);
    return ask.p_W ? problem_with_place(*ask.p_W) : std::string();
  }
  std::string operator()(const core::SetVelocity& ask) const { return problem_with_speed(ask.v_WB, c.launch); }
  std::string operator()(const core::SetRate& ask) const {
    if (c.launch.time.pace == config::Pace::kNone) return "this run goes as fast as it can (time.pace: none)";
    const bool fits = ask.rate > 0 && ask.rate <= kFastestRate;
    return fits ? std::string() : fmt::format("a rate of {:.4g}, allowed: above 0, at most {}", ask.rate, kFastestRate);
  }
  std::string operator()(const core::Repartition& ask) const {
    if (ask.boxes.size() != c.launch.regions.size()) {
      return fmt::format("{} regions for {} nodes: there has to be one for each", ask.boxes.size(),
                         c.launch.regions.size());
    }
    return problem_with_change([&] { config::with_regions(c.launch, ask.boxes); });
  }
  std::string operator()(const core::ChangeScene& ask) const {
    return problem_with_change([&] { config::with_scene(c.launch, ask.name); });
  }
  std::string operator()(const core::Ray&) const { return {}; }
};

}  // namespace

std::string problem_with(const core::Ask& ask, const CommandContext& context) {
  return std::visit(Problem{context}, ask);
}

}  // namespace aurasim::cli
