#include "process/checkpoints.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace aurasim::process {
namespace {

using Kind = messages::Checkpoint::Kind;

/// Number of states kept of each region. Nodes are a few states apart, and a keeper may have received only every other
/// part.
constexpr std::size_t kStates = 6;
/// Number of own parts after which the other regions' parts of the state that all went back to are dropped.
constexpr std::ptrdiff_t kOwnAfterwards = 3;

}  // namespace

void Checkpoints::move_to(dds::Participant& participant) {
  bus_.emplace(participant, region_);
  keepers_.clear();
}

void Checkpoints::begin_era(core::Generation era) {
  era_ = era;
  coming_.clear();
  kept_.clear();
  wards_.clear();
  all_had_.reset();
}

void Checkpoints::use_keepers(std::vector<core::RegionId> keepers, core::Generation life) {
  bus_->use_keepers(keepers, life);
  keepers_ = std::move(keepers);
}

void Checkpoints::add(cut::SavedWorld part, core::Step recorded) {
  const core::Step step = part.cut.step;
  coming_.push_back(
      {step, recorded, std::async(std::launch::async, [part = std::move(part)] { return encode(part); })});
}

std::optional<core::Step> Checkpoints::waits_for() const {
  return coming_.empty() ? std::nullopt : std::optional(coming_.front().recorded);
}

void Checkpoints::progress(core::Step recorded) {
  take();
  while (!coming_.empty() && coming_.front().recorded <= recorded &&
         coming_.front().octets.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    Coming part = std::move(coming_.front());
    coming_.pop_front();
    keep(region_, part.step, part.octets.get());
    send_to_keepers(part.step);
    forget_what_all_had();
  }
}

void Checkpoints::take() {
  for (messages::Checkpoint& one : bus_->take()) {
    if (one.kind == Kind::kToKeep) {
      if (one.generation != era_) continue;
      wards_.insert(one.source);
      keep(one.source, one.step, std::move(one.octets));
      continue;
    }
    if (one.generation < given_.generation) continue;
    if (one.generation > given_.generation) given_ = {one.generation, {}, {}};
    (one.kind == Kind::kGoBack ? given_.parts : given_.orders)[one.source] = std::move(one.octets);
  }
}

void Checkpoints::keep(core::RegionId region, core::Step step, std::string octets) {
  std::map<core::Step, std::string>& states = kept_[region];
  states.insert_or_assign(step, std::move(octets));
  if (states.size() > kStates) states.erase(states.begin());
}

/// Sends this node's part to its keepers. If a link is too slow for all parts, some are left out.
void Checkpoints::send_to_keepers(core::Step step) {
  const std::string& octets = kept_[region_][step];
  const std::size_t sent = bus_->send_to_keepers({region_, Kind::kToKeep, era_, step, octets});
  left_out_ += keepers_.size() - sent;
  sent_bytes_ += sent * octets.size();
}

void Checkpoints::forget_what_all_had() {
  const auto& own = kept_[region_];
  if (!all_had_ || std::ssize(own) < kOwnAfterwards || std::prev(own.end(), kOwnAfterwards)->first <= *all_had_) return;
  for (auto& [region, states] : kept_) {
    if (!wards_.contains(region)) states.erase(*all_had_);
  }
  all_had_.reset();
}

std::vector<messages::KeptPart> Checkpoints::parts() const {
  std::vector<messages::KeptPart> parts;
  for (const auto& [region, states] : kept_) {
    for (const auto& [step, octets] : states) parts.push_back({region, step});
  }
  return parts;
}

const std::string* Checkpoints::find(core::RegionId region, core::Step step) const {
  const auto states = kept_.find(region);
  if (states == kept_.end()) return nullptr;
  const auto part = states->second.find(step);
  return part == states->second.end() ? nullptr : &part->second;
}

void Checkpoints::go_back(core::Generation era, core::Step step, const std::map<core::RegionId, std::string>& parts) {
  if (era != era_) begin_era(era);
  coming_.clear();
  for (auto& [region, states] : kept_) states.erase(states.upper_bound(step), states.end());
  for (const auto& [region, octets] : parts) keep(region, step, octets);
  wards_.clear();
  all_had_ = step;
  given_.parts.clear();
  given_.orders.clear();
}

const std::map<core::RegionId, std::string>& Checkpoints::given(core::Generation generation, Kind kind) {
  take();
  static const std::map<core::RegionId, std::string> kNothing;
  if (given_.generation != generation) return kNothing;
  return kind == Kind::kGoBack ? given_.parts : given_.orders;
}

}  // namespace aurasim::process
