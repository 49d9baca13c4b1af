#include "process/recovery.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using messages::NodeState;

constexpr auto kPatienceWithSpare = 5s;
constexpr auto kLaunchersFirst = 5s;
/// Patience with a node that is reachable but receives from too few others. A repaired link is noticed within a second
/// or two.
constexpr auto kPatienceWithCutOff = 5s;
/// Patience with discovery, which takes about a second in a healthy network.
constexpr auto kPatienceWithDiscovery = 2500ms;
constexpr auto kPatienceOfSuccessor = 30s;
constexpr auto kPatienceWithStandIn = 20s;
constexpr int kMostStandIns = 3;  // in a row for one region, near one state

std::vector<std::uint32_t> numbers_of(const std::vector<core::RegionId>& regions) {
  std::vector<std::uint32_t> numbers;
  for (const core::RegionId region : regions) numbers.push_back(core::value_of(region));
  return numbers;
}

bool stands(NodeState state) {
  return state == NodeState::kRecovering || state == NodeState::kSpare || state == NodeState::kCutOff;
}

}  // namespace

bool is_reachable(const messages::SeenStatus& seen) { return !seen.lost && !seen.has_ended(); }

std::vector<core::RegionId> unreachable_regions(const SeenNodes& nodes, core::RegionId self, std::uint32_t regions) {
  std::vector<core::RegionId> unreachable;
  for (std::uint32_t r = 0; r < regions; ++r) {
    const auto seen = nodes.find(core::RegionId{r});
    const bool receives = core::RegionId{r} == self || (seen != nodes.end() && is_reachable(seen->second));
    if (!receives) unreachable.push_back(core::RegionId{r});
  }
  return unreachable;
}

std::optional<core::Step> newest_complete(const SeenNodes& nodes, core::Generation era, std::uint32_t regions) {
  std::map<core::Step, std::set<core::RegionId>> kept;
  for (const auto& [region, seen] : nodes) {
    if (!is_reachable(seen) || seen.status.era != era) continue;
    for (const messages::KeptPart& part : seen.status.parts) kept[part.step].insert(part.region);
  }
  for (auto state = kept.rbegin(); state != kept.rend(); ++state) {
    if (state->second.size() == regions) return state->first;
  }
  return std::nullopt;
}

std::optional<std::string> why_stand(const SeenNodes& nodes, const OwnWorld& own) {
  if (own.restore != nullptr && own.restore->generation > own.current) return "all nodes go back to an earlier state";
  if (own.is_going_back && own.restore->region != own.region) {
    const auto lead = nodes.find(own.restore->region);
    const std::uint64_t process = own.restore->members.at(core::value_of(own.restore->region)).process;
    if (lead != nodes.end() && lead->second.status.process != process)
      return "the node that sent the restore command has left";
  }
  for (const auto& [region, seen] : nodes) {
    const auto is_member = [&, number = core::value_of(region)] {
      return own.restore != nullptr && number < own.restore->members.size() &&
             own.restore->members[number].process == seen.status.process;
    };
    // The status may still be of the process that died, because that of its replacement has not come yet.
    if (region == own.region || (own.is_going_back && !is_member())) continue;
    const NodeState state = seen.status.state;
    const std::uint32_t number = core::value_of(region);
    if (seen.lost && !seen.has_ended()) return fmt::format("the node of region {} has died", number);
    if (!seen.has_ended() && std::ranges::find(own.silent, region) != own.silent.end()) {
      return fmt::format("the node of region {} is silent, or has published an invalid message", number);
    }
    if (!seen.lost && state == NodeState::kFailed) {
      const std::string& why = seen.status.text;
      return fmt::format("the node of region {} has given up{}{}", number, why.empty() ? "" : ": ", why);
    }
    const bool is_missed = own.coupled_in && seen.status.step <= *own.coupled_in && !own.is_going_back;
    if (is_missed && state == NodeState::kFinished && seen.status.generation == own.current) {
      return fmt::format("the node of region {} has ended", number);
    }
    // The node has left, and its successor waits. (After a recovery, statuses of nodes that have begun may come late.)
    if (!own.is_going_back && !seen.lost && state == NodeState::kSpare && !is_member()) {
      return fmt::format("the node of region {} has left", number);
    }
    if (!seen.lost && stands(state) && seen.status.generation >= own.current) {
      return fmt::format("the node of region {} reports that a node has died", number);
    }
  }
  return std::nullopt;
}

RestoreMeaning meaning_of(const messages::RunCommand& restore, core::RegionId region, std::uint64_t process,
                          core::Generation begun, core::Generation known) {
  if (restore.generation <= begun) return RestoreMeaning::kNothing;
  if (restore.members.at(core::value_of(region)).process != process) {
    return restore.generation < known ? RestoreMeaning::kLeftOut : RestoreMeaning::kReplaced;
  }
  return restore.generation > known ? RestoreMeaning::kGoBack : RestoreMeaning::kNothing;
}

std::string what_recovery_waits_for(bool is_cut_off, const std::string& question,
                                    const std::vector<core::RegionId>& vacant,
                                    const std::vector<core::RegionId>& unreachable) {
  if (is_cut_off) return "receives from too few of the other nodes, and waits for them";
  if (!question.empty()) return question;
  if (!vacant.empty()) {
    return fmt::format("waits for processes that take over regions [{}]", fmt::join(numbers_of(vacant), ", "));
  }
  if (!unreachable.empty()) {
    return fmt::format("does not receive from regions [{}], from which other nodes receive",
                       fmt::join(numbers_of(unreachable), ", "));
  }
  return "waits until all other nodes have stopped computing";
}

std::string nobody_takes_over(const std::vector<core::RegionId>& vacant) {
  return fmt::format("nobody takes over regions [{}], whose nodes have died", fmt::join(numbers_of(vacant), ", "));
}

void Recovery::begin(Clock::time_point now) {
  began_ = somebody_came_ = alone_since_ = idle_since_ = now;
  cut_off_since_.clear();
  unmet_since_.reset();
}

RecoveryActs Recovery::look(const RecoveryView& view, Clock::time_point now) {
  RecoveryActs acts;
  for (const auto& [region, seen] : view.nodes) {
    const bool computes = seen.status.state == NodeState::kRunning || seen.status.state == NodeState::kPaused;
    const auto left_out = left_out_.find(seen.status.generation);
    if (is_reachable(seen) && computes && left_out != left_out_.end()) acts.replaced_in = left_out->second;
  }
  acts.meets_anew = meets_anew(view, now);
  for (std::uint32_t r = 0; r < settings_.regions; ++r) {
    if (is_vacant(core::RegionId{r}, view.nodes, now)) acts.vacant.push_back(core::RegionId{r});
  }
  std::erase_if(called_, [&](const auto& call) {
    return std::ranges::find(acts.vacant, call.first) == acts.vacant.end() || now > call.second + kPatienceWithSpare;
  });
  if (acts.vacant.empty() || !view.may_go_on) {
    somebody_came_ = now;
    return acts;
  }
  if (!view.knows_world) return acts;
  if (calls_spares(view.nodes, now)) {
    for (const core::RegionId region : acts.vacant) {
      if (!called_.contains(region)) acts.call_spares.push_back(region);
    }
  }
  if (now <= somebody_came_ + settings_.patience) return acts;
  somebody_came_ = now + kPatienceWithStandIn - settings_.patience;
  // With a launcher, no stand-in is started: a launcher that starts no process has its own reasons.
  acts.gives_up = settings_.has_launcher;
  for (const core::RegionId region : acts.vacant) {
    acts.gives_up = acts.gives_up || tried_too_often(region, view.step);
    if (!acts.gives_up && is_next_after(region, view)) acts.stand_ins.push_back(region);
  }
  return acts;
}

/// A region is vacant in two cases. Neither this node nor any node that it receives from gets messages of the region's
/// node; or that node has published for some seconds that it receives from too few others, because only one direction
/// of its link works.
bool Recovery::is_vacant(core::RegionId region, const SeenNodes& nodes, Clock::time_point now) {
  if (region == settings_.region) return false;
  const auto seen = nodes.find(region);
  if (seen != nodes.end() && is_reachable(seen->second)) {
    if (seen->second.status.state != NodeState::kCutOff) {
      cut_off_since_.erase(region);
      return false;
    }
    const auto since = cut_off_since_.try_emplace(region, now).first->second;
    return now > since + kPatienceWithCutOff;
  }
  cut_off_since_.erase(region);
  return std::ranges::none_of(nodes, [&](const auto& entry) {
    const auto& [other, status] = entry;
    if (other == region || other == settings_.region || !is_reachable(status)) return false;
    if (status.status.state != NodeState::kRecovering) return false;
    return std::ranges::find(status.status.dead, region) == status.status.dead.end();
  });
}

/// True if this process has to leave DDS and join it again. One direction of a link may have been down, or both for
/// about as long as a lease. Then the lease has run out at one of two processes and not at the other. Fast DDS 2.9.1
/// never matches such a pair again, because the acknowledgements of the one count from the beginning and the other
/// takes them for old. A process that joins DDS anew is a new one to both.
bool Recovery::meets_anew(const RecoveryView& view, Clock::time_point now) {
  const bool is_unreachable = std::ranges::any_of(view.nodes, [this](const auto& entry) {
    const auto& [region, seen] = entry;
    const bool receives_most = seen.status.state == NodeState::kRecovering || seen.status.state == NodeState::kSpare;
    return region != settings_.region && is_reachable(seen) && receives_most &&
           std::ranges::find(seen.status.dead, settings_.region) != seen.status.dead.end();
  });
  if (!settings_.can_be_cut || !(is_unreachable || view.is_cut_off)) {
    unmet_since_.reset();
    return false;
  }
  if (!unmet_since_) unmet_since_ = met_ = now;
  // On a busy machine or a bad network discovery takes longer, so the wait grows with each attempt.
  const auto patience = std::max<Clock::duration>(kPatienceWithDiscovery, (now - *unmet_since_) / 4);
  if (now < met_ + patience) return false;
  met_ = now;
  return true;
}

/// True if this node is to call spares: it is the lowest region that waits. A launcher starts its own nodes again, and
/// faster, so it gets time first.
bool Recovery::calls_spares(const SeenNodes& nodes, Clock::time_point now) const {
  if (settings_.has_launcher && now < began_ + kLaunchersFirst) return false;
  return std::ranges::none_of(nodes, [this](const auto& entry) {
    return entry.first < settings_.region && !entry.second.lost && entry.second.status.state == NodeState::kRecovering;
  });
}

std::optional<std::uint64_t> Recovery::call_spare(const std::vector<messages::Status>& spares, core::RegionId region,
                                                  Clock::time_point now) {
  const auto free = std::ranges::find_if(
      spares, [this](const messages::Status& spare) { return !called_spares_.contains(spare.process); });
  if (free == spares.end()) return std::nullopt;
  called_spares_.insert(free->process);
  called_[region] = now;
  return free->process;
}

bool Recovery::tried_too_often(core::RegionId region, core::Step step) {
  StandIn& tried = stood_in_[region];
  const bool at_the_same_place = std::abs(step - tried.at) <= settings_.checkpoint_steps;
  tried = {at_the_same_place ? tried.times + 1 : 1, step};
  return tried.times > kMostStandIns;
}

bool Recovery::is_next_after(core::RegionId region, const RecoveryView& view) const {
  for (std::uint32_t i = 1; i < settings_.regions; ++i) {
    const core::RegionId next{(core::value_of(region) + i) % settings_.regions};
    if (next == settings_.region) return !view.leaving.contains(view.process);
    const auto other = view.nodes.find(next);
    if (other != view.nodes.end() && other->second.is_live() && !view.leaving.contains(other->second.status.process)) {
      return false;
    }
  }
  return false;
}

void Recovery::note_kept(const SeenNodes& nodes, core::Generation era) {
  if (kept_era_ != era) kept_.reset();
  kept_era_ = era;
  if (const auto newest = newest_complete(nodes, era, settings_.regions)) kept_ = std::max(kept_.value_or(0), *newest);
}

/// True if all reachable nodes of other regions have only come to take over, too. A node that is cut off still knows
/// the world.
bool Recovery::nobody_knows_the_world(const SeenNodes& nodes, Clock::time_point now) {
  const bool somebody_does = std::ranges::any_of(nodes, [this](const auto& entry) {
    return entry.first != settings_.region && is_reachable(entry.second) &&
           entry.second.status.state != NodeState::kSpare;
  });
  if (somebody_does) alone_since_ = now;
  return now > alone_since_ + kPatienceOfSuccessor;
}

bool Recovery::is_not_needed(const SeenNodes& nodes, Clock::time_point now) {
  bool computes = false, waits = false, has_finished = false;
  std::uint32_t there = 0;
  for (const auto& [region, seen] : nodes) {
    has_finished = has_finished || seen.status.state == NodeState::kFinished;
    if (region == settings_.region || !is_reachable(seen)) continue;
    ++there;
    computes = computes || seen.status.state == NodeState::kRunning;
    waits = waits || seen.status.state == NodeState::kRecovering || seen.status.state == NodeState::kCutOff;
  }
  if (has_finished && there == 0) return true;
  if (!computes || waits) idle_since_ = now;
  return now > idle_since_ + kPatienceOfSuccessor;
}

}  // namespace aurasim::process
