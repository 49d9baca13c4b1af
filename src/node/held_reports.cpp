#include "node/held_reports.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace aurasim::node {

void HeldReports::add(StepReport report) {
  if (!redo_) {
    given_out_.push_back(std::move(report));
    return;
  }
  if (report.put_back_from) drop_after(report.step);
  for (const HashPart& part : report.hash) {
    hashes_.push_back({report.step, report.put_back_from.has_value(), part});
  }
  report.hash.clear();
  if (report.put_back_from || report.step > released_) held_.push_back(std::move(report));
}

/// Drops what was reported of states after `step`, to which the run has gone back. Bodies that had joined `step` late
/// join it anew.
void HeldReports::drop_after(core::Step step) {
  std::erase_if(held_, [step](const StepReport& one) { return one.step > step; });
  std::erase_if(
      hashes_, [step](const HeldHash& one) { return one.told_in > step || (one.told_in == step && one.told_by_redo); });
}

void HeldReports::release(core::Step confirmed) {
  while (!held_.empty() && held_.front().step <= confirmed) {
    StepReport& report = given_out_.emplace_back(std::move(held_.front()));
    held_.pop_front();
    released_ = std::max(released_, report.step);
    release_hashes(released_ - lookahead_, report);  // the last bodies that join for a state do so K states later
  }
}

/// Gives out the hashes of states up to `until`, which nothing can join any more. Hashes given out before are left out.
void HeldReports::release_hashes(core::Step until, StepReport& report) {
  std::erase_if(hashes_, [&](const HeldHash& one) {
    if (one.part.step > until) return false;
    if (one.part.step > hashed_) report.hash.push_back(one.part);
    return true;
  });
  hashed_ = std::max(hashed_, until);
}

void HeldReports::finish(core::Step last) {
  StepReport rest;  // bodies that joined later have made up their part of the last states
  rest.step = last;
  const auto is_of_the_run = [last](const auto& effect) { return effect.step <= last; };
  for (const StepReport& later : held_) {
    std::ranges::copy_if(later.arrivals, std::back_inserter(rest.arrivals),
                         [last](const HandOffRow& row) { return row.stamp <= last; });
    std::ranges::copy_if(later.effects.bodies, std::back_inserter(rest.effects.bodies), is_of_the_run);
    std::ranges::copy_if(later.effects.joints, std::back_inserter(rest.effects.joints), is_of_the_run);
  }
  release_hashes(last, rest);
  if (!rest.arrivals.empty() || !rest.hash.empty()) given_out_.push_back(std::move(rest));
  held_.clear();
  hashes_.clear();
}

}  // namespace aurasim::node
