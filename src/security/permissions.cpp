#include "security/permissions.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fnmatch.h>

namespace aurasim::security {
namespace {

constexpr std::array<const char*, kRoleCount> kRoleNames = {"region", "spare", "viewer", "operator", "recorder"};

const std::string kWorld = "world";
const std::string kEveryRegion = "region/*";  // includes the partitions between regions
const std::string kEveryObserver = "region/*/observer/*";

/// Margin on both dates, because Fast DDS reads them in the time zone of its host.
constexpr std::chrono::hours kTimeZones{24};

/// Partitions in which a node publishes for neighbours and observers. After a death the generation is part of the
/// partition's name.
std::vector<std::string> from(const std::string& region) {
  return {fmt::format("region/{}", region), fmt::format("region/{}/since/*", region)};
}

/// Rights of a node. `region` is a number, or `*` for a process that may become the node of any region.
Grants grants_of_node(const std::string& region) {
  const std::string to_any = fmt::format("region/{}/to/*", region);
  const std::vector<std::string> own = {fmt::format("region/{}", region)};
  const std::vector<std::string> to_it = {fmt::format("region/*/to/{}", region),
                                          fmt::format("region/*/to/{}/since/*", region)};
  std::vector<std::string> kept_here = to_it;
  kept_here.push_back(kWorld);
  Grants grants;
  grants.publishes = {{"aura", from(region)},
                      {"migration", {to_any}},
                      {"migration_ack", {to_any}},
                      {"node_status", own},
                      {"region_map", {kWorld}},
                      {"run_control", {kWorld}},
                      {"replica", own},
                      {"replica_key", own},
                      {"cluster_graph", own},
                      {"observation", {fmt::format("region/{}/observer/*", region)}},
                      {"command_reply", {kWorld}},
                      {"orders", {kWorld}},
                      {"shape", {kWorld}},
                      {"checkpoint", {to_any, kWorld}}};
  // The regions that it receives from change with the bodies (docs/decisions/0003), so it may read all.
  grants.subscribes = {{"aura", {kEveryRegion}},        {"migration", to_it},     {"migration_ack", to_it},
                       {"node_status", {kEveryRegion}}, {"region_map", {kWorld}}, {"run_control", {kWorld}},
                       {"command", {kWorld}},           {"shape", {kWorld}},      {"checkpoint", kept_here},
                       {"control", {kWorld}},           {"interest", {kWorld}}};
  return grants;
}

std::vector<Grant> what_viewers_see() {
  return {{"node_status", {kEveryRegion}},
          {"region_map", {kWorld}},
          {"replica", {kEveryRegion}},
          {"replica_key", {kEveryRegion}},
          {"cluster_graph", {kEveryRegion}},
          {"aura", {kEveryRegion}},
          {"orders", {kWorld}},
          {"shape", {kWorld}},
          {"observation", {kEveryObserver}}};
}

/// Right of observers to publish their interests.
const Grant kInterest = {"interest", {kWorld}};

Grants grants_of_operator() {
  Grants grants;
  grants.publishes = {
      {"command", {kWorld}}, {"shape", {kWorld}}, {"run_control", {kWorld}}, {"control", {kWorld}}, kInterest};
  grants.subscribes = what_viewers_see();
  grants.subscribes.push_back({"command_reply", {kWorld}});
  grants.subscribes.push_back({"run_control", {kWorld}});
  return grants;
}

Grants grants_of_recorder() {
  Grants grants;
  for (const char* topic : {"aura", "migration", "migration_ack", "node_status", "region_map", "run_control", "replica",
                            "replica_key", "command", "command_reply", "shape", "orders", "cluster_graph", "checkpoint",
                            "control", "interest", "observation"}) {
    grants.subscribes.push_back({topic, {"*"}});
  }
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
      return grants_of_node(std::to_string(region));
    case Role::kSpare:
      return grants_of_node("*");
    case Role::kOperator:
      return grants_of_operator();
    case Role::kRecorder:
      return grants_of_recorder();
    case Role::kViewer:
      break;
  }
  return {{kInterest}, what_viewers_see()};
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
