#include "config/static_paths.h"

#include <cmath>

#include <fmt/format.h>

#include "config/keys_of.h"
#include "config/scene_draft.h"
#include "core/limits.h"
#include "core/static_path.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostStops = 1000;
constexpr double kShortestWay_s = 0.01;
/// Largest slope of the smooth curve of motion, relative to the mean speed.
constexpr double kSteepest = 1.5;

const KeysOf<core::StaticPath>& keys_of_path() {
  using core::StaticPath;
  static const KeyTable kStop{
      .title = "stop of a path",
      .about =
          "The pose of a static at a time, as `position` and `orientation` in its own axes, relative to its pose "
          "at the start.",
      .keys = {required("at", number(Range::above(0, 1e6), "s"), "when it is there, from the start on")}};
  static const KeysOf<StaticPath> keys(
      "path of a static",
      "From where it stands straight from stop to stop, and on the shorter turn. It pushes what is in its way, and "
      "nothing pushes it. Solver soft_step only.",
      {required("stops", list(1, kMostStops, map([]() -> const KeyTable& { return kStop; }).with(pose_keys)),
                "in the order of time"),
       optional("repeats", &StaticPath::repeats, flag(),
                "from the start again after the last stop, which is where it stands at the start; else it stays there"),
       optional("smooth", &StaticPath::smooth, flag(),
                "it rests for a moment at each stop; else it goes evenly between two, and its speed jumps")});
  return keys;
}

/// Checks the way between two stops. A turn of more than half a circle cannot be distinguished from the
/// shorter one the other way round.
void check_way(const Field& field, const core::PathStop& before, const core::PathStop& stop, bool smooth) {
  const double duration_s = stop.at_s - before.at_s;
  if (duration_s < kShortestWay_s) {
    field.complain(
        fmt::format("found at: {:g}, allowed: at least {:g} s after the stop before", stop.at_s, kShortestWay_s));
    return;
  }
  const double cosine = std::abs(before.X_SP.q_WB.normalized().dot(stop.X_SP.q_WB.normalized()));
  const double turn_rad = 2 * std::acos(std::min(1.0, cosine));
  const double times = (smooth ? kSteepest : 1) / duration_s;
  const double v = (stop.X_SP.p_WB - before.X_SP.p_WB).norm() * times, w = turn_rad * times;
  if (v > core::limits::kFastestStatic_m_s || w > core::limits::kFastestStatic_rad_s) {
    field.complain(
        fmt::format("found a way of up to {:.3g} m/s and {:.3g} rad/s to here, allowed: {:g} m/s and {:g} rad/s", v, w,
                    core::limits::kFastestStatic_m_s, core::limits::kFastestStatic_rad_s));
  }
}

bool is_start(const core::Pose& X_SP) {
  constexpr double kRounded = 1e-9;
  return X_SP.p_WB.norm() < kRounded && std::abs(X_SP.q_WB.normalized().w()) > 1 - kRounded;
}

}  // namespace

const KeyTable& path_keys() { return keys_of_path(); }

std::optional<core::StaticPath> read_path(const Field& field) {
  if (!field.given()) return std::nullopt;
  core::StaticPath path;
  const Fields fields(field, keys_of_path());
  keys_of_path().read_members(fields, path);
  for (const Field& item : fields["stops"].items()) {
    const Fields stop_fields(item);
    core::PathStop stop;
    stop.at_s = stop_fields["at"].number().value_or(path.stops.empty() ? 1 : path.stops.back().at_s + 1);
    stop.X_SP = read_pose(stop_fields);
    stop_fields.close();
    check_way(item, path.stops.empty() ? core::PathStop{} : path.stops.back(), stop, path.smooth);
    path.stops.push_back(stop);
  }
  fields.close();
  if (path.stops.empty()) return std::nullopt;
  if (path.repeats && !is_start(path.stops.back().X_SP)) {
    field.complain(
        "found a last stop elsewhere, allowed: with `repeats`, the one where it stands at the start "
        "(position [0, 0, 0], not turned)");
  }
  return path;
}

}  // namespace aurasim::config
