// Violations: promises about speed, latency, frame time, path or span that did not hold, so that the world may be
// wrong.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/ids.h"

namespace aurasim::core {

enum class ViolationKind : std::uint8_t {
  kSpeed,    ///< a body is faster than the promised V (value and allowed in m/s)
  kLatency,  ///< a message took effect later than K steps after its stamp, or a setpoint after its own state (steps)
  kFrame,    ///< computing a step took longer than T_F (s)
  kPromise,  ///< a body is not where its last aura promised it would be (m)
  kSpan,     ///< a body is near a region that does not listen to its host (m: distance between the two regions)
};
inline constexpr int kViolationKinds = 5;

struct Violation {
  ViolationKind kind{};
  Step step = 0;
  RegionId region{};  ///< the region that broke the promise: the neighbour for kLatency, the reporting node otherwise
  BodyId body{};      ///< for kSpeed, kPromise, kSpan
  double value = 0;
  double allowed = 0;
};

/// Counts all violations, and keeps the first 32 of the current step for the report.
class ViolationLog {
 public:
  void start_step() { recent_.clear(); }
  void add(const Violation& violation) {
    ++counts_[static_cast<std::size_t>(violation.kind)];
    last_step_ = violation.step;
    if (recent_.size() < 32) recent_.push_back(violation);
  }

  /// Notes that a promise whose violation was counted before is still broken at `step`: a new warning, but no new
  /// violation.
  void still_broken(Step step) {
    ++repeated_;
    last_step_ = step;
  }
  /// Grows with every violation, and in every step in which one goes on.
  std::uint64_t warnings() const { return total() + repeated_; }

  std::uint64_t count(ViolationKind kind) const { return counts_[static_cast<std::size_t>(kind)]; }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t c : counts_) sum += c;
    return sum;
  }
  /// The step of the newest violation or warning; far in the past if there was none.
  Step last_step() const { return last_step_; }
  const std::vector<Violation>& recent() const { return recent_; }

 private:
  std::array<std::uint64_t, kViolationKinds> counts_{};
  std::uint64_t repeated_ = 0;
  Step last_step_ = -1'000'000;
  std::vector<Violation> recent_;
};

}  // namespace aurasim::core
