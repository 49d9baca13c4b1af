#include "lab/metrics.h"

#include <algorithm>

namespace aurasim::lab {

double penetration_time_s(const Contact& contact) {
  return contact.relative_speed_m_s > 0 ? contact.penetration_m / contact.relative_speed_m_s : 0;
}

bool is_late(const Contact& contact, double step_s) { return penetration_time_s(contact) > step_s * (1 + 1e-9); }

bool is_missed(const std::optional<Contact>& contact, bool met_in_one_world) { return met_in_one_world && !contact; }

bool is_thrashed(std::uint64_t hand_offs) { return hand_offs > 1; }

void Tally::add(const Trial& trial) {
  if (!trial.central_step) return;
  ++trials;
  late += trial.late();
  missed += trial.missed();
  thrashed += trial.thrashed();
  pulled_twice += trial.pulls > 1;
  late_without_violation += trial.late_without_violation();
  missed_without_violation += trial.missed_without_violation();
  later_than_central += trial.later_than_central();
  same_bits += trial.same_bits;
  with_violations += trial.violations > 0;
  slow_down_sum += trial.slow_down;
  slow_down_most = std::max(slow_down_most, trial.slow_down);
  if (trial.contact) penetration_time_most_s = std::max(penetration_time_most_s, penetration_time_s(*trial.contact));
}

void Tally::add(const Tally& other) {
  trials += other.trials;
  late += other.late;
  missed += other.missed;
  thrashed += other.thrashed;
  pulled_twice += other.pulled_twice;
  late_without_violation += other.late_without_violation;
  missed_without_violation += other.missed_without_violation;
  later_than_central += other.later_than_central;
  same_bits += other.same_bits;
  with_violations += other.with_violations;
  slow_down_sum += other.slow_down_sum;
  slow_down_most = std::max(slow_down_most, other.slow_down_most);
  penetration_time_most_s = std::max(penetration_time_most_s, other.penetration_time_most_s);
}

}  // namespace aurasim::lab
