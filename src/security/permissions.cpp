#include "security/permissions.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fnmatch.h>

#include "topics/topics.h"

namespace aurasim::security {
namespace {

constexpr std::array<const char*, kRoleCount> kRoleNames = {"region", "spare", "viewer", "operator", "recorder", "hub"};

/// Margin on both dates, because Fast DDS reads them in the time zone of its host.
constexpr std::chrono::hours kTimeZones{24};

using topics::Topic;

/// Partitions of a route, in all lives of the run.
std::vector<std::string> partitions_of(const Topic& topic, const topics::Route& route) {
  std::vector<std::string> partitions = {topics::partition_of(topic.id, route)};
  // A pattern that ends in `*` matches the partitions of later lives, too.
  if (topic.by_life && !partitions.front().ends_with('*')) {
    partitions.push_back(topics::in_later_lives(partitions.front()));
  }
  if (topic.division == topics::Division::kByPairAndToAll) partitions.emplace_back(topics::kWorldPartition);
  return partitions;
}

/// Adds the right to publish on a topic: to the readers, and to the hub where it passes the messages on.
void grant_to_publish(Grants& grants, const Topic& topic, const topics::Route& route = {}) {
  const std::vector<std::string> partitions = partitions_of(topic, route);
  Grant grant{topic.name, partitions};
  for (const std::string& partition : partitions) {
    if (topics::goes_by_hub(topic.id, partition)) grant.partitions.push_back(topics::to_hub(partition));
  }
  grants.publishes.push_back(std::move(grant));
}

/// Adds the right to read a topic: from those who publish, and from the hub where it passes the messages on.
void grant_to_read(Grants& grants, const Topic& topic, const topics::Route& route = {}) {
  Grant grant{topic.name, partitions_of(topic, route)};
  if (topics::has_way_by_hub(topic.id)) grant.partitions.emplace_back(topics::kFromHub);
  grants.subscribes.push_back(std::move(grant));
}

/// Rights of the node of `region`; without a region: of the node of any. It may read from all sources, because the
/// regions that it receives from change with the bodies (docs/decisions/0003).
Grants grants_of_node(std::optional<core::RegionId> region) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (topic.published_by & topics::kNodes) grant_to_publish(grants, topic, {.source = region});
    if (topic.read_by & topics::kNodes) grant_to_read(grants, topic, {.destination = region});
  }
  return grants;
}

/// Rights of a process that is not a node. `parties`: set of topics::Party.
Grants grants_of_others(std::uint8_t parties) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (topic.published_by & parties) grant_to_publish(grants, topic);
    if (topic.read_by & parties) grant_to_read(grants, topic);
  }
  return grants;
}

Grants grants_of_recorder() {
  Grants grants;
  for (const Topic& topic : topics::all()) grants.subscribes.push_back({topic.name, {"*"}});
  return grants;
}

/// Rights of a hub: what nodes publish to all nodes, and nothing else.
Grants grants_of_hub() {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (!topics::has_way_by_hub(topic.id)) continue;
    grants.publishes.push_back({topic.name, {topics::kFromHub}});
    grants.subscribes.push_back({topic.name, {topics::kEveryPartitionToHub}});
  }
  return grants;
}

std::string xml_date(Seconds at) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(at)));
}

constexpr const char* kPublish = "publish";
constexpr const char* kSubscribe = "subscribe";

std::string rule(const Grant& grant, const char* direction) {
  std::string partitions;
  for (const std::string& partition : grant.partitions)
    partitions += fmt::format("<partition>{}</partition>", partition);
  return fmt::format(
      "<allow_rule><domains><id_range><min>0</min><max>232</max></id_range></domains><{0}><topics><topic>{1}</topic>"
      "</topics><partitions>{2}</partitions></{0}></allow_rule>",
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
    case Role::kHub:
      return grants_of_hub();
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
  for (const Grant& grant : grants.publishes) text += rule(grant, kPublish) + "\n";
  for (const Grant& grant : grants.subscribes) text += rule(grant, kSubscribe) + "\n";
  return text + "<default>DENY</default></grant></permissions></dds>\n";
}

bool has_rules(const std::string& document, const Grants& grants) {
  const auto has = [&](const std::vector<Grant>& all, const char* direction) {
    return std::ranges::all_of(
        all, [&](const Grant& grant) { return document.find(rule(grant, direction)) != std::string::npos; });
  };
  return has(grants.publishes, kPublish) && has(grants.subscribes, kSubscribe);
}

}  // namespace aurasim::security
