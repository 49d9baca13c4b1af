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

constexpr std::array<const char*, kRoleCount> kRoleNames = {"region", "spare", "viewer", "operator", "recorder"};

/// Margin on both dates, because Fast DDS reads them in the time zone of its host.
constexpr std::chrono::hours kTimeZones{24};

using topics::Topic;

/// Adds the right to use a topic in the partitions of a route, in all lives of the run.
void grant(std::vector<Grant>& grants, const Topic& topic, const topics::Route& route = {}) {
  std::vector<std::string> partitions = {topics::partition_of(topic.id, route)};
  // A pattern that ends in `*` matches the partitions of later lives, too.
  if (topic.by_life && !partitions.front().ends_with('*')) {
    partitions.push_back(topics::in_later_lives(partitions.front()));
  }
  if (topic.division == topics::Division::kByPairAndToAll) partitions.emplace_back(topics::kWorldPartition);
  grants.push_back({topic.name, std::move(partitions)});
}

/// Rights of the node of `region`; without a region: of the node of any. It may read from all sources, because the
/// regions that it receives from change with the bodies (docs/decisions/0003).
Grants grants_of_node(std::optional<core::RegionId> region) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (topic.published_by & topics::kNodes) grant(grants.publishes, topic, {.source = region});
    if (topic.read_by & topics::kNodes) grant(grants.subscribes, topic, {.destination = region});
  }
  return grants;
}

/// Rights of a process that is not a node. `parties`: set of topics::Party.
Grants grants_of_others(std::uint8_t parties) {
  Grants grants;
  for (const Topic& topic : topics::all()) {
    if (topic.published_by & parties) grant(grants.publishes, topic);
    if (topic.read_by & parties) grant(grants.subscribes, topic);
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
