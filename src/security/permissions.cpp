#include "security/permissions.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fnmatch.h>

#include "topics/topics.h"

namespace aurasim::security {
namespace {

constexpr std::array<const char*, kRoleCount> kRoleNames = {"region", "spare", "viewer", "operator", "recorder"};

/// Margin on both dates, because Fast DDS reads them in the time zone of its host.
constexpr std::chrono::hours kTimeZones{24};

using topics::Division;
using topics::Topic;

/// Partitions in which the node of `region` publishes; without a region: the node of any.
std::vector<std::string> published_from(const Topic& topic, std::optional<core::RegionId> region) {
  std::vector<std::string> partitions = {topics::partition_of(topic.id, {.source = region})};
  if (topic.division == Division::kBySource && topic.by_life) {
    partitions.push_back(topics::in_later_lives(partitions.front()));
  }
  if (topic.division == Division::kByPairAndToAll) partitions.emplace_back(topics::kWorldPartition);
  return partitions;
}

/// Partitions that the node of `region` reads. The regions that it receives from change with the bodies
/// (docs/decisions/0003), so it may read those of all sources.
std::vector<std::string> read_by_node(const Topic& topic, std::optional<core::RegionId> region) {
  std::vector<std::string> partitions = {topics::partition_of(topic.id, {.destination = region})};
  const bool to_one = topic.division == Division::kByPair || topic.division == Division::kByPairAndToAll;
  if (to_one) partitions.push_back(topics::in_later_lives(partitions.front()));
  if (topic.division == Division::kByPairAndToAll) partitions.emplace_back(topics::kWorldPartition);
  return partitions;
}

Grants grants_of_node(std::optional<core::RegionId> region) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (topic.published_by & topics::kNodes) grants.publishes.push_back({topic.name, published_from(topic, region)});
    if (topic.read_by & topics::kNodes) grants.subscribes.push_back({topic.name, read_by_node(topic, region)});
  }
  return grants;
}

/// Rights of a process that is not a node. `parties`: set of topics::Party.
Grants grants_of_others(std::uint8_t parties) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    const std::vector<std::string> partitions = {topics::partition_of(topic.id)};
    if (topic.published_by & parties) grants.publishes.push_back({topic.name, partitions});
    if (topic.read_by & parties) grants.subscribes.push_back({topic.name, partitions});
  }
  return grants;
}

Grants grants_of_recorder() {
  Grants grants;
  for (const Topic& topic : topics::all()) grants.subscribes.push_back({topic.name, {"*"}});
  return grants;
}

std::string xml_date(Seconds at) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(at)));
}

std::string rule(const Grant& grant, const char* direction) {
  std::string partitions;
  for (const std::string& partition : grant.partitions)
    partitions += fmt::format("<partition>{}</partition>", partition);
  return fmt::format(
      "<allow_rule><domains><id_range><min>0</min><max>232</max></id_range></domains><{0}><topics><topic>{1}</topic>"
      "</topics><partitions>{2}</partitions></{0}></allow_rule>\n",
      direction, grant.topic, partitions);
}

}  // namespace

const char* name_of(Role role) { return kRoleNames.at(static_cast<std::size_t>(role)); }

std::optional<Role> role_named(std::string_view name) {
  const auto found = std::ranges::find(kRoleNames, name);
  if (found == kRoleNames.end()) return std::nullopt;
  return static_cast<Role>(found - kRoleNames.begin());
}

Grants grants_of(Role role, std::uint32_t region) {
  switch (role) {
    case Role::kRegion:
      return grants_of_node(core::RegionId{region});
    case Role::kSpare:
      return grants_of_node({});
    case Role::kOperator:
      return grants_of_others(topics::kOperators | topics::kViewers);
    case Role::kRecorder:
      return grants_of_recorder();
    case Role::kViewer:
      break;
  }
  return grants_of_others(topics::kViewers);
}

bool is_granted(const std::vector<Grant>& grants, std::string_view topic, const std::string& partition) {
  const auto grant = std::ranges::find(grants, topic, &Grant::topic);
  return grant != grants.end() && std::ranges::any_of(grant->partitions, [&](const std::string& pattern) {
           return ::fnmatch(pattern.c_str(), partition.c_str(), FNM_NOESCAPE) == 0;
         });
}

std::string permissions_document(const Subject& subject, const Validity& valid, const Grants& grants) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<dds><permissions><grant name=\"{}\"><subject_name>{}</subject_name>"
      "<validity><not_before>{}</not_before><not_after>{}</not_after></validity>\n",
      subject.name, subject.text(), xml_date(valid.from - kTimeZones), xml_date(valid.until + kTimeZones));
  for (const Grant& grant : grants.publishes) text += rule(grant, "publish");
  for (const Grant& grant : grants.subscribes) text += rule(grant, "subscribe");
  return text + "<default>DENY</default></grant></permissions></dds>\n";
}

}  // namespace aurasim::security
