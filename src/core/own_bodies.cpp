#include "core/own_bodies.h"

#include <utility>

namespace aurasim::core {

void OwnBodies::measure(std::uint32_t i, const BodyState& body, Step now) {
  ids_[i] = body.id;
  paths_[i] = path_of(body, now, aura_.clearance());
  paths_[i].speed_m_s = aura_.speed_of(body);
  top_radius_ = std::max(top_radius_, paths_[i].radius_m);
  top_speed_ = std::max(top_speed_, paths_[i].speed_m_s);
  if (!paths_[i].moves) resting_speed_ = std::max(resting_speed_, paths_[i].speed_m_s);
}

void OwnBodies::look(const Snapshot& snapshot) {
  goes_on_ = snapshot.goes_on_from(seen_);
  seen_ = snapshot.number;
  if (used_room_.is_spare(goes_on_ ? snapshot.changed.size() : snapshot.bodies.size())) {
    free_memory(changed_, ids_before_, paths_before_);
  }
  changed_.clear();
  if (goes_on_) {
    paths_before_.clear();
    for (const std::uint32_t i : snapshot.changed) paths_before_.push_back(paths_[i]);
    changed_.assign(snapshot.changed.begin(), snapshot.changed.end());
    top_speed_ = resting_speed_;
    for (const std::uint32_t i : changed_) measure(i, snapshot.bodies[i], snapshot.step);
    return;
  }
  std::swap(ids_, ids_before_);
  std::swap(paths_, paths_before_);
  top_speed_ = resting_speed_ = top_radius_ = 0;
  ids_.resize(snapshot.bodies.size());
  paths_.resize(snapshot.bodies.size());
  for (std::uint32_t i = 0; i < paths_.size(); ++i) measure(i, snapshot.bodies[i], snapshot.step);
}

/// Bodies are looked for somewhat farther inside than asked, so that all are looked at now and then only.
void OwnBodies::find_close(double distance_m) {
  constexpr double kSpare = 1.25, kTooFar = 4;
  const bool holds = goes_on_ && distance_m <= close_m_ && close_m_ <= kTooFar * distance_m;
  if (!holds) {
    close_m_ = kSpare * distance_m;
    close_.clear();
    for (std::uint32_t i = 0; i < paths_.size(); ++i) {
      if (is_close(i)) close_.push_back(i);
    }
    return;
  }
  for (const std::uint32_t i : changed_) {
    if (!is_close(i)) continue;
    const auto place = std::ranges::lower_bound(close_, i);
    if (place == close_.end() || *place != i) close_.insert(place, i);
  }
}

std::optional<std::uint32_t> OwnBodies::find(BodyId id) const {
  const auto found = std::ranges::lower_bound(ids_, id);
  if (found == ids_.end() || *found != id) return std::nullopt;
  return static_cast<std::uint32_t>(found - ids_.begin());
}

}  // namespace aurasim::core
