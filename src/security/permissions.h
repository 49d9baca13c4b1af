// Which role may publish and read which topics in which partitions (docs/protocol.md), and the same as the document
// that DDS-Security reads.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "security/certificates.h"

namespace aurasim::security {

enum class Role : std::uint8_t {
  kRegion,    ///< the node of one region
  kSpare,     ///< waits for a region and then becomes its node; may publish as any region
  kViewer,    ///< observes the world and the nodes, publishes nothing
  kOperator,  ///< a viewer that may also send commands, and start, pause and stop the run
  kRecorder,  ///< reads everything, publishes nothing
  kHub,       ///< publishes again what nodes publish to all nodes, in the partition topics::kFromHub
};
inline constexpr int kRoleCount = 6;
const char* name_of(Role role);
std::optional<Role> role_named(std::string_view name);

/// A right to use these partitions of a topic. Patterns as in fnmatch, whose `*` matches `/` too.
struct Grant {
  std::string topic;
  std::vector<std::string> partitions;
};

struct Grants {
  std::vector<Grant> publishes;
  std::vector<Grant> subscribes;
};

/// Returns the rights of a role. `region` is used for kRegion only.
Grants grants_of(Role role, std::uint32_t region = 0);

/// True when a partition is granted, decided as Fast DDS does. A partition that is a pattern itself is granted only if
/// the grant matches it as text.
bool is_granted(const std::vector<Grant>& grants, std::string_view topic, const std::string& partition);

/// Returns the permissions document, XML. It has one rule for each topic and direction, because topics in one rule
/// would share all its partitions, and of several rules for a topic Fast DDS reads the first only.
std::string permissions_document(const Subject& subject, const Validity& valid, const Grants& grants);
/// True if a permissions document has the rules of all these rights.
bool has_rules(const std::string& document, const Grants& grants);

}  // namespace aurasim::security
