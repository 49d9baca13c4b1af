// Who may say what, and listen to what: by role, topic and partition (docs/protocol.md), and as the document that
// DDS-Security reads.
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
  kSpare,     ///< waits for a region, and then is its node: may speak for any
  kViewer,    ///< sees the world and the nodes, says nothing
  kOperator,  ///< a viewer that may also ask something of the world, and start, pause and stop the run
  kRecorder,  ///< reads everything, says nothing
};
inline constexpr int kRoleCount = 5;
const char* name_of(Role role);
std::optional<Role> role_named(std::string_view name);

/// In these partitions of a topic; patterns as of fnmatch, whose `*` crosses `/`.
struct Grant {
  std::string topic;
  std::vector<std::string> partitions;
};

struct Grants {
  std::vector<Grant> publishes;
  std::vector<Grant> subscribes;
};

/// `region` counts for kRegion only.
Grants grants_of(Role role, std::uint32_t region = 0);

/// As Fast DDS decides. A partition that is a pattern itself is granted only if the grant covers its letters.
bool is_granted(const std::vector<Grant>& grants, std::string_view topic, const std::string& partition);

/// One rule for each topic and direction: topics in one rule would share all its partitions, and of several rules for a
/// topic Fast DDS reads the first only. XML.
std::string permissions_document(const Subject& subject, const Validity& valid, const Grants& grants);

}  // namespace aurasim::security
