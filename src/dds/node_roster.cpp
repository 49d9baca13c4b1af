#include "dds/node_roster.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <utility>

#include <fmt/format.h>

#include "messages/status_period.h"

namespace aurasim::dds {

using core::RegionId;
using core::value_of;

namespace {

/// Limits on what is remembered of other processes, trusted or not.
constexpr std::size_t kMostOfARegion = 64;   ///< processes that claim to be the node of one region
constexpr std::size_t kMostOfNoRegion = 64;  ///< processes that claim regions that the run does not have, together
constexpr std::size_t kMostClaims = 1024;

/// Samples kept to estimate a sender's clock: about the last second, as clocks may be set. A sample that was long under
/// way makes the clock look late, so the fastest gives the best estimate.
constexpr std::size_t kSamplesOfAClock = 10;

std::uint16_t host_of(const Guid& guid) {
  return static_cast<std::uint16_t>(guid.guidPrefix.value[2] << 8 | guid.guidPrefix.value[3]);
}

/// A process shows no life when no status has come for so many periods.
constexpr int kShowsNoLife = 3;

/// True when a process acts as a node. A process that only waits does no harm; a successor, or a second launch of the
/// same file by mistake, does.
bool acts(const messages::Status& status) {
  return status.state == messages::NodeState::kRunning || status.state == messages::NodeState::kPaused ||
         status.state == messages::NodeState::kRecovering;
}

constexpr int kIsNode = 2;

/// Rank of a process that claims a region; the highest one is its node. Live processes come first, and among them those
/// that have not only come to take over from another. `stands`: it is the node so far. Then it remains so at its end,
/// until it has left: it still answers messages that are under way to it, and no takeover is needed.
int rank_of(const messages::SeenStatus& seen, bool stands) {
  if (stands && !seen.lost && seen.status.state == messages::NodeState::kFinished) return kIsNode;
  return !seen.is_live() ? 0 : seen.status.state == messages::NodeState::kSpare ? 1 : kIsNode;
}

/// Finds the latest match of a writer. Null: it was never matched.
const RemoteWriter* find(const std::vector<RemoteWriter>& writers, const Guid& guid) {
  const auto found = std::find_if(writers.rbegin(), writers.rend(), [&](const auto& w) { return w.guid == guid; });
  return found == writers.rend() ? nullptr : &*found;
}

}  // namespace

bool NodeRoster::is_region(RegionId region) const {
  return region != messages::kNoRegion && value_of(region) < settings_.region_count;
}

std::string NodeRoster::problem_with(const messages::Status& fresh, const Origin& origin) const {
  const std::uint32_t number = value_of(fresh.region);
  if (!speakers_.is_at_home(origin.writer, fresh.region)) {
    return fmt::format("it publishes a status of region {} in the partition of another", number);
  }
  const auto known = statuses_.find(fresh.region);
  const bool has_node = known != statuses_.end() && rank_of(known->second, true) == kIsNode &&
                        publishers_.at(fresh.region) != origin.writer;
  const bool says_so = has_node && acts(fresh) && is_of_the_run(fresh, origin.writer);
  return says_so ? fmt::format("region {} has another node", number) : std::string();
}

bool NodeRoster::has_room_for(RegionId region) const {
  if (is_region(region) || region == messages::kNoRegion) {
    const auto known = received_.find(region);
    return known == received_.end() || known->second.size() < kMostOfARegion;
  }
  std::size_t others = 0;
  for (const auto& [other, of_region] : received_) others += is_region(other) ? 0 : of_region.size();
  return others < kMostOfNoRegion;
}

void NodeRoster::note(messages::Status fresh, const Origin& origin) {
  if (!has_room_for(fresh.region)) return;
  fresh_.insert(fresh.region);
  std::vector<Received>& of_region = received_[fresh.region];
  auto found = std::ranges::find(of_region, origin.writer, &Received::writer);
  if (found == of_region.end()) {
    found = of_region.insert(found, {origin.writer, origin.by_hub, {}, {}, {}});
  }
  found->seen.status = std::move(fresh);
  found->seen.seen = settings_.now();
  found->seen.host = host_of(origin.writer);
  found->clock_ahead.push_back(origin.clock_ahead);
  if (found->clock_ahead.size() > kSamplesOfAClock) found->clock_ahead.pop_front();
  found->seen.clock_ahead = std::ranges::max(found->clock_ahead);
}

void NodeRoster::look(const std::vector<RemoteWriter>& writers) {
  has_death_ = false;
  fresh_.clear();
  hub_silence_.look(writers, speakers_, settings_.now());
  for (auto& [region, of_region] : received_) look_at(region, of_region, writers);
}

void NodeRoster::look_at_news(const std::vector<RemoteWriter>& writers) {
  if (has_death_) return look(writers);
  for (const RegionId region : std::exchange(fresh_, {})) look_at(region, received_.at(region), writers);
}

void NodeRoster::look_at(RegionId region, std::vector<Received>& of_region, const std::vector<RemoteWriter>& writers) {
  for (Received& one : of_region) {
    if (claimed_.contains(one.seen.status.process) && shows_no_life(one)) dead_.insert(one.seen.status.process);
    one.seen.dead = dead_.contains(one.seen.status.process);
    if (one.by_hub && !shows_no_life(one)) one.alive = settings_.now();
    one.seen.lost = one.seen.dead || is_lost(one, find(writers, one.writer));
  }
  if (is_region(region)) choose_publisher(region, of_region);
  std::erase_if(of_region, [&](const Received& one) { return one.seen.lost && one.writer != publishers_[region]; });
}

void NodeRoster::choose_publisher(RegionId region, const std::vector<Received>& of_region) {
  const Received* chosen = nullptr;
  std::pair highest(-1, false);
  for (const Received& one : of_region) {
    if (!is_of_the_run(one)) continue;
    const bool stands = publishers_.contains(region) && publishers_[region] == one.writer;
    const std::pair rank(rank_of(one.seen, stands), stands);
    if (rank <= highest) continue;
    chosen = &one;
    highest = rank;
  }
  if (chosen == nullptr) return;
  publishers_[region] = chosen->writer;
  statuses_[region] = chosen->seen;
  speakers_.set(region, chosen->writer.guidPrefix);
}

bool NodeRoster::is_lost(const Received& one, const RemoteWriter* writer) const {
  if (one.by_hub) {
    return settings_.stays_on_this_host
               ? shows_no_life(one) && settings_.now() >= one.alive + settings_.until_last_word
               : hub_silence_.is_believed(one.seen.seen, settings_.silence_by_hub, settings_.now());
  }
  if (writer == nullptr || writer->lost) return true;
  return !settings_.believes_silence && writer->silent_since && shows_no_life(one);
}

/// On this host the operating system is asked whether the process exists. Elsewhere its statuses decide.
bool NodeRoster::shows_no_life(const Received& one) const {
  if (!settings_.stays_on_this_host) {
    const auto limit = kShowsNoLife * messages::status_period(settings_.region_count);
    if (one.by_hub) return hub_silence_.is_believed(one.seen.seen, limit, settings_.now());
    return settings_.now() > one.seen.seen + limit;
  }
  const auto pid = static_cast<::pid_t>(one.seen.status.pid);
  return pid <= 0 || (::kill(pid, 0) != 0 && errno == ESRCH);
}

bool NodeRoster::is_of(std::uint64_t process, const Origin& origin) const {
  return std::ranges::any_of(received_, [&](const auto& entry) {
    return std::ranges::any_of(entry.second, [&](const Received& one) {
      return one.seen.status.process == process && one.writer.guidPrefix == origin.writer.guidPrefix;
    });
  });
}

bool NodeRoster::is_of(RegionId region, const Origin& origin) const {
  const auto known = received_.find(region);
  return known != received_.end() && std::ranges::any_of(known->second, [&](const Received& one) {
           return is_of_the_run(one) && one.writer.guidPrefix == origin.writer.guidPrefix;
         });
}

bool NodeRoster::is_of_the_run(const messages::Status& s, const Guid& writer) const {
  if (!is_region(s.region) && s.region != messages::kNoRegion) return false;
  if (speakers_.shuns(writer.guidPrefix)) return false;
  if (settings_.agreement && s.agreement != *settings_.agreement) return false;
  if (settings_.run && s.run != *settings_.run) return false;
  return settings_.region != s.region || writer == settings_.writer;
}

std::vector<messages::SeenStatus> NodeRoster::strangers() const {
  std::vector<messages::SeenStatus> strangers;
  for (const auto& [region, of_region] : received_) {
    for (const Received& one : of_region) {
      if (region != messages::kNoRegion && one.seen.is_live() && !is_of_the_run(one)) strangers.push_back(one.seen);
    }
  }
  return strangers;
}

std::vector<messages::Status> NodeRoster::spares() const {
  std::vector<messages::Status> spares;
  const auto of_no_region = received_.find(messages::kNoRegion);
  if (of_no_region == received_.end()) return spares;
  for (const Received& one : of_no_region->second) {
    if (one.seen.is_live() && is_of_the_run(one)) spares.push_back(one.seen.status);
  }
  return spares;
}

bool NodeRoster::receive_death(std::uint64_t process) {
  for (const auto& [region, of_region] : received_) {
    const auto meant =
        std::ranges::find(of_region, process, [](const Received& one) { return one.seen.status.process; });
    if (meant == of_region.end()) continue;
    if (settings_.stays_on_this_host && !shows_no_life(*meant)) return false;
    if (claimed_.size() < kMostClaims) claimed_.insert(process);
    has_death_ = true;
  }
  return true;
}

}  // namespace aurasim::dds
