#include "config/launch_variants.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace aurasim::config {
namespace {

/// Writes a box as text. Infinite sides become finite, slightly beyond the outermost finite ones; reading extends them
/// again.
std::string box_text(const core::Rectangle& box, const core::Rectangle& bounds) {
  const auto number = [](double x, double otherwise) { return std::isfinite(x) ? x : otherwise; };
  return fmt::format("[{}, {}, {}, {}]", number(box.x0, bounds.x0), number(box.y0, bounds.y0),
                     number(box.x1, bounds.x1), number(box.y1, bounds.y1));
}

std::string override_of(Exchange exchange) {
  return exchange == Exchange::kCoupled ? "exchange=coupled" : "exchange=aura";
}

/// Keeps what `exchange: auto` means in the run, whatever it would mean after the change.
Launch reread(const Launch& launch, const std::string& change) {
  std::vector<std::string> overrides = launch.overrides;
  if (!launch.why_exchange.empty() && launch.regions.size() > 1) overrides.push_back(override_of(launch.exchange));
  overrides.push_back(change);
  return read_launch(launch.file, overrides);
}

}  // namespace

Launch with_exchange(const Launch& launch, Exchange exchange) { return reread(launch, override_of(exchange)); }

Launch with_regions(const Launch& launch, const std::vector<core::Rectangle>& boxes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kFurther_m = 100;
  core::Rectangle bounds{kInfinity, kInfinity, -kInfinity, -kInfinity};
  const auto extend = [](double& low, double& high, double x) {
    if (!std::isfinite(x)) return;
    low = std::min(low, x - kFurther_m);
    high = std::max(high, x + kFurther_m);
  };
  for (const core::Rectangle& box : boxes) {
    for (const double x : {box.x0, box.x1}) extend(bounds.x0, bounds.x1, x);
    for (const double y : {box.y0, box.y1}) extend(bounds.y0, bounds.y1, y);
  }
  if (!std::isfinite(bounds.x0)) bounds.x0 = -kFurther_m, bounds.x1 = kFurther_m;
  if (!std::isfinite(bounds.y0)) bounds.y0 = -kFurther_m, bounds.y1 = kFurther_m;
  std::string text;
  for (const core::Rectangle& box : boxes) text += (text.empty() ? "" : ", ") + box_text(box, bounds);
  const std::string distance =
      launch.neighbour_distance_is_given ? fmt::format(", neighbour_distance: {}", launch.neighbour_distance_m) : "";
  return reread(launch, fmt::format("regions={{layout: boxes, boxes: [{}]{}}}", text, distance));
}

Launch with_scene(const Launch& launch, const std::string& name) {
  const bool plain = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  const std::filesystem::path file = launch.scene_file.parent_path() / (name + ".yaml");
  if (!plain || !std::filesystem::exists(file)) {
    throw BadConfig({fmt::format("there is no scene \"{}\"", name)});
  }
  return reread(launch, "scene=" + file.string());
}

}  // namespace aurasim::config
