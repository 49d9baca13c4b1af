#include "records/compare.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

#include "core/body_state.h"
#include "records/report_rows.h"

namespace aurasim::records {
namespace {

using Hashes = std::map<core::Step, Hex64>;
using Poses = std::map<core::BodyId, core::Pose>;

/// Throws if a file has broken rows, because half of a row is no state to compare.
void refuse_broken(std::size_t rows, const std::filesystem::path& file) {
  if (rows > 0) throw std::runtime_error(fmt::format("{}: {} broken rows", file.string(), rows));
}

Hashes read_hashes(const std::filesystem::path& folder) {
  Hashes hashes;
  const std::filesystem::path file = folder / "state_hash.csv";
  refuse_broken(read_csv<HashRow>(file, [&](const HashRow& row) { hashes[row.step] = row.hash; }), file);
  if (hashes.empty()) throw std::runtime_error(file.string() + ": no hashes");
  return hashes;
}

Poses read_poses(const std::filesystem::path& folder) {
  Poses poses;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_directory() || !entry.path().filename().string().starts_with("region_")) continue;
    const std::filesystem::path file = entry.path() / "bodies.csv";
    const std::size_t broken = read_csv<BodyRow>(file, [&](const BodyRow& row) {
      if (row.where != BodyRow::kHere) return;
      poses[row.body] = {{row.x_m, row.y_m, row.z_m}, {row.qw, row.qx, row.qy, row.qz}};
    });
    refuse_broken(broken, file);
  }
  return poses;
}

void compare_hashes(const Hashes& a, const Hashes& b, Comparison& result) {
  result.first_step = std::max(a.begin()->first, b.begin()->first);
  std::uint64_t steps = 0;
  for (const auto& [step, hash] : a) {
    steps += step >= result.first_step;
    const auto other = b.find(step);
    if (other == b.end()) continue;
    ++result.steps_compared;
    if (other->second != hash && !result.first_difference_step) result.first_difference_step = step;
  }
  const bool same_end = a.rbegin()->first == b.rbegin()->first;
  const auto after = static_cast<std::uint64_t>(std::distance(b.lower_bound(result.first_step), b.end()));
  const bool same_steps = same_end && result.steps_compared == steps && steps == after && steps > 0;
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

}  // namespace aurasim::records
