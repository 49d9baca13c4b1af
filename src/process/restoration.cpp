#include "process/restoration.h"

#include <utility>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kShortStand = 5s;  ///< time for which a stop does not break off a recovery

}  // namespace

void Restoration::begin(Clock::time_point now) {
  since_ = now;
  stop_asked_ = false;
}

void Restoration::begin_attempt(core::Generation generation) {
  waits_in_ = newest(generation);
  is_going_back_ = false;
}

void Restoration::go_back() {
  restoring_ = restore_->generation;
  is_going_back_ = true;
}

RestoreMeaning Restoration::meaning(const messages::RunCommand& restore, core::RegionId region, std::uint64_t process,
                                    core::Generation generation, core::Generation begun) const {
  const core::Generation known = std::max(newest(generation), restore_ ? restore_->generation : 0);
  return meaning_of(restore, region, process, begun, known);
}

OwnWorld Restoration::own_world(core::RegionId region, core::Generation generation,
                                std::vector<core::RegionId> silent) const {
  OwnWorld own;
  own.region = region;
  own.current = newest(generation);
  own.silent = std::move(silent);
  own.restore = restore_ ? &*restore_ : nullptr;
  own.is_going_back = is_going_back_;
  return own;
}

bool Restoration::is_stopped(Clock::time_point now) const { return stop_asked_ && now > since_ + kShortStand; }

bool Restoration::ask(const std::string& question) { return std::exchange(question_, question) != question; }

bool Restoration::break_off(const std::string& why) {
  if (is_broken_off()) return false;
  broken_off_ = why;
  return true;
}

}  // namespace aurasim::process
