#include "node/compare.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

#include "core/body_state.h"
#include "node/csv.h"

namespace aurasim::node {
namespace {

using Cells = std::vector<std::string_view>;
using Hashes = std::map<core::Step, std::string>;
using Poses = std::map<std::uint64_t, core::Pose>;

Hashes read_hashes(const std::filesystem::path& folder) {
  Hashes hashes;
  read_csv(folder / "state_hash.csv", [&](const Cells& c) {
    if (c.size() == 2) hashes[static_cast<core::Step>(whole(c[0]))] = std::string(c[1]);
  });
  if (hashes.empty()) throw std::runtime_error((folder / "state_hash.csv").string() + ": no hashes");
  return hashes;
}

Poses read_poses(const std::filesystem::path& folder) {
  Poses poses;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_directory() || !entry.path().filename().string().starts_with("region_")) continue;
    read_csv(entry.path() / "bodies.csv", [&](const Cells& c) {
      if (c.size() != 12 || c[4] != "here") return;
      core::Pose& pose = poses[whole(c[1])];
      pose.p_WB = {number(c[5]), number(c[6]), number(c[7])};
      pose.q_WB = {number(c[8]), number(c[9]), number(c[10]), number(c[11])};
    });
  }
  return poses;
}

void compare_hashes(const Hashes& a, const Hashes& b, Comparison& result) {
  for (const auto& [step, hash] : a) {
    const auto other = b.find(step);
    if (other == b.end()) continue;
    ++result.steps_compared;
    if (other->second != hash && !result.first_difference_step) result.first_difference_step = step;
  }
  const bool same_steps = a.size() == b.size() && result.steps_compared == a.size();
  result.hashes_equal = same_steps && !result.first_difference_step;
}

void compare_poses(const Poses& a, const Poses& b, Comparison& result) {
  for (const auto& [body, pose] : a) {
    const auto other = b.find(body);
    if (other == b.end()) continue;
    ++result.bodies_compared;
    result.max_position_error_m = std::max(result.max_position_error_m, (pose.p_WB - other->second.p_WB).norm());
    result.max_rotation_error_rad =
        std::max(result.max_rotation_error_rad, pose.q_WB.angularDistance(other->second.q_WB));
  }
  result.bodies_in_one_only = a.size() + b.size() - 2 * result.bodies_compared;
}

}  // namespace

Comparison compare_reports(const std::filesystem::path& a, const std::filesystem::path& b) {
  Comparison result;
  compare_hashes(read_hashes(a), read_hashes(b), result);
  compare_poses(read_poses(a), read_poses(b), result);
  return result;
}

}  // namespace aurasim::node
