#include "process/node_ending.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kStopGently = 900ms;        // time for a node to reach the state in which all stop; longer if it gets on
constexpr auto kStopSurely = 1600ms;       // a node without sign of life is killed after this
constexpr auto kSilence = 3s;              // no sign of life: lost, and no status for so long
constexpr auto kPatienceWithEnding = 30s;  // patience with a node that shows life

}  // namespace

Urge NodeEnding::urge(Clock::time_point now, const messages::SeenStatus* seen) {
  if (is_given_up(now, seen)) return Urge::kKill;
  if (!is_stuck(now, seen) || terminated_) return Urge::kNone;
  terminated_ = true;
  return Urge::kTerminate;
}

bool NodeEnding::is_given_up(Clock::time_point now, const messages::SeenStatus* seen) const {
  const auto waited = now - begin_;
  if (waited > kPatienceWithEnding) return true;
  if (waited <= kStopSurely) return false;
  return seen == nullptr || (!seen->has_ended() && seen->lost && now - seen->seen > kSilence);
}

bool NodeEnding::is_stuck(Clock::time_point now, const messages::SeenStatus* seen) {
  if (seen != nullptr && seen->has_ended()) return false;
  if (seen != nullptr && seen->status.step > step_) {
    step_ = seen->status.step;
    moved_ = now;
  }
  return now - begin_ > kStopGently && now - moved_ > standstill_;
}

}  // namespace aurasim::process
