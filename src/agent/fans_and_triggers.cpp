#include "agent/fans_and_triggers.h"

#include <algorithm>
#include <iterator>

namespace aurasim::agent {
namespace {

/// Number of interests remembered; far more than can be under way.
constexpr std::size_t kMostAsked = 256;
constexpr double kLeastMargin_m = 2;
constexpr double kMarginOfReach = 0.25;

const WorldBody* find(const std::vector<WorldBody>& bodies, core::BodyId id) {
  const auto place = std::ranges::lower_bound(bodies, id, {}, [](const WorldBody& body) { return body.row.id; });
  return place != bodies.end() && place->row.id == id ? &*place : nullptr;
}

}  // namespace

std::optional<core::Pose> Mount::pose_in(const std::vector<WorldBody>& bodies) const {
  if (!carrier) return X_CS;
  const WorldBody* const body = find(bodies, *carrier);
  if (body == nullptr) return std::nullopt;
  return core::Pose{body->row.p_WB, body->row.q_WB.cast<double>().normalized()} * X_CS;
}

bool TriggerSpec::holds(const core::Pose& X_WS, const core::Vec3& p_WB) const {
  const core::Vec3 p_SB = X_WS.q_WB.conjugate() * (p_WB - X_WS.p_WB);
  if (radius_m > 0) return p_SB.squaredNorm() <= radius_m * radius_m;
  return (p_SB.cwiseAbs().array() <= half_extents.array()).all();
}

TriggerResult Trigger::look(const std::vector<WorldBody>& bodies) {
  TriggerResult result;
  const std::optional<core::Pose> X_WS = spec_.mount.pose_in(bodies);
  for (const WorldBody& body : bodies) {
    const bool is_inside = X_WS && body.row.id != spec_.mount.carrier && spec_.holds(*X_WS, body.row.p_WB);
    if (is_inside) result.inside.push_back(body.row.id);
  }
  std::ranges::set_difference(result.inside, inside_, std::back_inserter(result.entered));
  std::ranges::set_difference(inside_, result.inside, std::back_inserter(result.left));
  inside_ = result.inside;
  result.complete = X_WS.has_value();
  return result;
}

Surroundings::Surroundings(Mount mount, double reach_m) : mount_(std::move(mount)), reach_m_(reach_m) {
  if (!mount_.carrier) now_ = Asked{0, mount_.X_CS.p_WB, reach_m};
}

double Surroundings::margin_m() const {
  return mount_.carrier ? std::max(kLeastMargin_m, kMarginOfReach * reach_m_) : 0;
}

bool Surroundings::follow(const core::Vec3& p_WS, double reach_m) {
  const bool is_there = now_ && (p_WS - now_->p_W).norm() <= margin_m() / 2 && reach_m <= reach_m_;
  if (is_there) return false;
  reach_m_ = reach_m;
  now_ = Asked{0, p_WS, reach_m + margin_m()};
  return true;
}

std::optional<core::WorldBox> Surroundings::box() const {
  if (!now_) return std::nullopt;
  const core::Vec3 half = core::Vec3::Constant(now_->reach_m);
  return core::WorldBox{now_->p_W - half, now_->p_W + half};
}

void Surroundings::note(std::uint64_t sequence) {
  if (!now_) return;
  asked_.push_back(*now_);
  asked_.back().sequence = sequence;
  if (asked_.size() > kMostAsked) asked_.erase(asked_.begin());
}

bool Surroundings::was_asked_for(std::uint64_t sequence, const core::Vec3& p_WS) const {
  const auto asked = std::ranges::find(asked_, sequence, &Asked::sequence);
  return asked != asked_.end() && (p_WS - asked->p_W).norm() + reach_m_ <= asked->reach_m;
}

}  // namespace aurasim::agent
