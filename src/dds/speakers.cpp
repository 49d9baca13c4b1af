#include "dds/speakers.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "rtps/datagram_guard.h"
#include "topics/topics.h"

namespace aurasim::dds {
namespace {

/// Limits on what is remembered of other processes, whatever they do: writers that are gone, processes, texts for the
/// log.
constexpr std::size_t kMostGone = 4096;
constexpr std::size_t kMostProcesses = 4096;
constexpr std::size_t kMostWords = 64;
constexpr std::size_t kMostFormer = 64;

constexpr std::string_view kRegionPartition = "region/";

/// Region of a partition's name: 3 for "region/3", "region/3/to/1" and "hub/region/3" (what goes by a hub is of that
/// region, too); -1 for anything else, wild cards included.
std::int64_t region_of_partition(std::string_view partition) {
  if (partition.starts_with(topics::kToHub)) partition.remove_prefix(topics::kToHub.size());
  if (!partition.starts_with(kRegionPartition)) return -1;
  partition.remove_prefix(kRegionPartition.size());
  std::uint32_t region = 0;
  const char* const last = partition.data() + partition.size();
  const auto [end, error] = std::from_chars(partition.data(), last, region);
  const bool is_region =
      error == std::errc{} && (end == last || *end == '/') && partition.find_first_of("*?[") == std::string_view::npos;
  return is_region ? std::int64_t{region} : -1;
}

}  // namespace

rtps::GuidPrefix prefix_of(const ProcessPrefix& process) {
  rtps::GuidPrefix prefix{};
  std::ranges::copy(process.value, prefix.begin());
  return prefix;
}

ProcessPrefix process_of(const rtps::GuidPrefix& prefix) {
  ProcessPrefix process;
  std::ranges::copy(prefix, std::begin(process.value));
  return process;
}

std::string text_of(const ProcessPrefix& process) {
  return fmt::format("{:02x}", fmt::join(std::begin(process.value), std::end(process.value), "."));
}

void Speakers::set_self(const ProcessPrefix& self) {
  const std::lock_guard lock(mutex_);
  self_ = self;
}

void Speakers::add(const Guid& writer, const std::vector<std::string>& partitions) {
  std::int64_t home = partitions.empty() ? -1 : region_of_partition(partitions.front());
  for (const std::string& partition : partitions) {
    if (region_of_partition(partition) != home) home = -1;
  }
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = homes_.try_emplace(writer, home);
  if (!is_new && known->second != home) known->second = -1;
}

void Speakers::remove(const Guid& writer) {
  const std::lock_guard lock(mutex_);
  gone_.push_back(writer);
  if (gone_.size() <= kMostGone) return;
  homes_.erase(gone_.front());
  gone_.pop_front();
}

void Speakers::add_hub(const ProcessPrefix& process) {
  const std::lock_guard lock(mutex_);
  hubs_.insert(process);
  if (guard_ != nullptr && !nodes_.empty()) tell_guard_of_nodes();
}

void Speakers::remove_hub(const ProcessPrefix& process) {
  const std::lock_guard lock(mutex_);
  hubs_.erase(process);
}

bool Speakers::is_hub(const ProcessPrefix& process) const {
  const std::lock_guard lock(mutex_);
  return hubs_.contains(process);
}

bool Speakers::has_hub() const {
  const std::lock_guard lock(mutex_);
  return !hubs_.empty();
}

void Speakers::set(core::RegionId region, const ProcessPrefix& process) {
  const std::lock_guard lock(mutex_);
  const auto [node, is_new] = nodes_.try_emplace(region, process);
  if (!is_new && node->second == process) return;
  if (!is_new) former_.push_back(std::exchange(node->second, process));
  if (former_.size() > kMostFormer) former_.pop_front();
  const bool was_shunned = shunned_.erase(process) > 0;
  if (guard_ == nullptr) return;
  if (was_shunned) guard_->forgive(prefix_of(process));
  tell_guard_of_nodes();
}

void Speakers::tell_guard_of_nodes() const {
  rtps::Repeats::Prefixes nodes;
  for (const auto& [region, process] : nodes_) {
    if (process != self_) nodes.insert(prefix_of(process));
  }
  if (nodes.empty()) return guard_->set_nodes({});                      // then every process counts as one
  for (const ProcessPrefix& hub : hubs_) nodes.insert(prefix_of(hub));  // what it asks for is for all
  guard_->set_nodes(std::move(nodes));
}

std::optional<ProcessPrefix> Speakers::of(core::RegionId region) const {
  const std::lock_guard lock(mutex_);
  const auto found = nodes_.find(region);
  return found == nodes_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<core::RegionId> Speakers::home_of(const Guid& writer) const {
  const std::lock_guard lock(mutex_);
  const auto home = homes_.find(writer);
  if (home == homes_.end() || home->second < 0) return std::nullopt;
  return core::RegionId{static_cast<std::uint32_t>(home->second)};
}

bool Speakers::is_at_home(const Guid& writer, core::RegionId region) const {
  const std::lock_guard lock(mutex_);
  const auto home = homes_.find(writer);
  return writer.guidPrefix == self_ || home == homes_.end() || home->second == std::int64_t{core::value_of(region)};
}

bool Speakers::may_speak(const Guid& endpoint, core::RegionId region) const {
  const std::lock_guard lock(mutex_);
  const auto node = nodes_.find(region);
  return endpoint.guidPrefix == self_ || node == nodes_.end() || node->second == endpoint.guidPrefix;
}

bool Speakers::is_node(const Guid& endpoint) const {
  const std::lock_guard lock(mutex_);
  const bool knows_others = std::ranges::any_of(nodes_, [this](const auto& node) { return node.second != self_; });
  return !knows_others || is_node_locked(endpoint.guidPrefix);
}

bool Speakers::is_node_locked(const ProcessPrefix& process) const {
  return process == self_ || std::ranges::any_of(nodes_, [&](const auto& node) { return node.second == process; });
}

void Speakers::refuse(const Guid& writer, const std::string& what) {
  const std::lock_guard lock(mutex_);
  if (is_node_locked(writer.guidPrefix)) return;  // nodes are counted and handled elsewhere
  const bool was_node = std::ranges::find(former_, writer.guidPrefix) != former_.end();
  refused_ += was_node ? 0 : 1;
  if (refused_of_.size() >= kMostProcesses && !refused_of_.contains(writer.guidPrefix)) return;
  const std::uint64_t count = ++refused_of_[writer.guidPrefix];
  if (count == 1 && !was_node) say_locked(fmt::format("process {} is refused: {}", text_of(writer.guidPrefix), what));
  if (count != kPatience) return;
  shun_locked(writer.guidPrefix, fmt::format("it has been refused {} times, lastly: {}", count, what));
}

void Speakers::ration(const Guid& writer, const std::string& what) {
  const std::lock_guard lock(mutex_);
  ++refused_;
  if (rationed_.size() >= kMostProcesses || !rationed_.emplace(writer.guidPrefix, what).second) return;
  say_locked(fmt::format("process {} sends more than it is allowed, and the rest is dropped: {}",
                         text_of(writer.guidPrefix), what));
}

void Speakers::shun(const ProcessPrefix& process, const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (!is_node_locked(process)) shun_locked(process, why);
}

void Speakers::shun_locked(const ProcessPrefix& process, const std::string& why) {
  if (shunned_.size() >= kMostProcesses || !shunned_.insert(process).second) return;
  if (guard_ != nullptr) guard_->shun(prefix_of(process));
  say_locked(fmt::format("process {} is not listened to any more: {}", text_of(process), why));
}

bool Speakers::shuns(const ProcessPrefix& process) const {
  const std::lock_guard lock(mutex_);
  return shunned_.contains(process);
}

std::uint64_t Speakers::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

void Speakers::say(std::string text) {
  const std::lock_guard lock(mutex_);
  say_locked(std::move(text));
}

void Speakers::say_locked(std::string text) {
  if (said_.size() < kMostWords) said_.push_back(std::move(text));
}

std::vector<std::string> Speakers::take_said() {
  const std::lock_guard lock(mutex_);
  return std::exchange(said_, {});
}

}  // namespace aurasim::dds
