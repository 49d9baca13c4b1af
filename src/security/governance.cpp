#include "security/governance.h"

#include <fmt/format.h>

namespace aurasim::security {
namespace {

/// Topics that observers read and that nodes act on. A process that may only read a topic has the key that decrypts it,
/// and could publish with it in its writer's name. So each message of these topics also carries an authentication code
/// for each of its readers. So does `checkpoint`, which all nodes read, from each other and from the hub.
constexpr const char* kTopicsOfManyReaders[] = {"aura",        "node_status", "region_map",
                                                "run_control", "shape",       "checkpoint"};

std::string topic_rule(const char* topic, const char* protection) {
  return fmt::format(
      "<topic_rule><topic_expression>{}</topic_expression>"
      "<enable_discovery_protection>true</enable_discovery_protection>"
      "<enable_liveliness_protection>true</enable_liveliness_protection>"
      "<enable_read_access_control>true</enable_read_access_control>"
      "<enable_write_access_control>true</enable_write_access_control>"
      "<metadata_protection_kind>{}</metadata_protection_kind>"
      "<data_protection_kind>NONE</data_protection_kind></topic_rule>\n",
      topic, protection);
}

}  // namespace

std::string governance_document() {
  std::string topics;
  for (const char* topic : kTopicsOfManyReaders) topics += topic_rule(topic, "ENCRYPT_WITH_ORIGIN_AUTHENTICATION");
  topics += topic_rule("*", "ENCRYPT");
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<dds><domain_access_rules><domain_rule>"
      "<domains><id_range><min>0</min><max>232</max></id_range></domains>"
      "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>"
      "<enable_join_access_control>true</enable_join_access_control>"
      "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>"
      "<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>"
      "<rtps_protection_kind>NONE</rtps_protection_kind>\n"
      "<topic_access_rules>\n{}</topic_access_rules></domain_rule></domain_access_rules></dds>\n",
      topics);
}

}  // namespace aurasim::security
