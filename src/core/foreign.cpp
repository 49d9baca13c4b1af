#include "core/foreign.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/aura_record.h"

namespace aurasim::core {
namespace {

/// Side of a block, in mean radii: a few bodies wide, since what is near a block is compared with each of its bodies.
constexpr double kBlockRadii = 8;

/// Index of a square along one axis, 22 bits. All that is farther out shares the outermost square: slower, never wrong.
std::uint64_t square_along(double x, double side_m) {
  constexpr double kHalf = 1 << 21;
  const double square = std::floor(x / side_m);
  return static_cast<std::uint64_t>(square > -kHalf ? std::min(square, kHalf - 1) + kHalf : 0);
}

}  // namespace

void ForeignBodies::add(const AuraRecord& aura, Step known, Step now, const Aura& rules) {
  const bool asleep = (aura.flags & kAuraAsleep) != 0;
  const bool ghost = (aura.flags & kAuraGhost) != 0;
  Foreign& f = bodies_.emplace_back();
  f.id = aura.id;
  f.host = aura.host;
  f.ghost = ghost;
  f.born = aura.birth <= aura.stamp;
  f.path = path_of(aura, rules.clearance());
  // An aura of a sleeping body is as fresh as its source's last batch. A ghost's aura is as old as its stamp.
  f.path.age_steps =
      static_cast<double>(std::max<Step>(0, now - std::max(asleep && !ghost ? known : aura.stamp, aura.birth)));
  f.path.unborn_steps = static_cast<double>(std::max<Step>(0, aura.birth - now));
}

std::optional<std::uint32_t> ForeignBodies::find(BodyId id) const {
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].id == id && !bodies_[i].ghost) return i;
  }
  return std::nullopt;
}

void ForeignBodies::build() {
  double radii = 0;
  for (const Foreign& foreign : bodies_) radii += foreign.path.radius_m;
  const double side = std::max(kBlockRadii * radii / static_cast<double>(bodies_.size()), 1e-3);
  order_.clear();
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    const Path& path = bodies_[i].path;
    const std::uint64_t kind = (std::uint64_t{value_of(bodies_[i].host)} << 1) + (path.speed_m_s > NearIndex::kSlow);
    const Vec3& p = path.pose.p_WB;
    order_.emplace_back((kind << 44) | (square_along(p.x(), side) << 22) | square_along(p.y(), side), i);
  }
  std::sort(order_.begin(), order_.end());
  sorted_.clear();
  for (const auto& [block, body] : order_) sorted_.push_back(body);
  blocks_.clear();
  for (std::size_t first = 0, last = 0; first < order_.size(); first = last) {
    while (last < order_.size() && order_[last].first == order_[first].first) ++last;
    add_block(std::span<const std::uint32_t>(sorted_).subspan(first, last - first));
  }
}

void ForeignBodies::add_block(std::span<const std::uint32_t> bodies) {
  ForeignBlock block{bodies_[bodies.front()].host, bodies, Vec3::Constant(std::numeric_limits<double>::infinity()),
                     Vec3::Constant(-std::numeric_limits<double>::infinity())};
  for (const std::uint32_t i : bodies) {
    const Path& path = bodies_[i].path;
    block.lo = block.lo.cwiseMin(path.pose.p_WB - Vec3::Constant(path.radius_m));
    block.hi = block.hi.cwiseMax(path.pose.p_WB + Vec3::Constant(path.radius_m));
  }
  blocks_.push_back(block);
}

}  // namespace aurasim::core
