// Which key of a run's keys (launch key dds.security) a process uses. Everything that is wrong is a BadConfig, which
// ends it with exit code 2; in an open run nobody has a key.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/settings.h"
#include "security/key_store.h"

namespace aurasim::cli {

using Roles = std::vector<security::Role>;

/// Keys `as`, or the first with one of these roles, the best first. A key of another role is refused.
std::optional<security::Member> member_for(const config::Launch& launch, const std::string& as, const Roles& roles);
/// The region's own, or else a spare's, which may speak for any.
std::optional<security::Member> member_for_node(const config::Launch& launch, const std::string& as,
                                                core::RegionId region);

/// `settings` with that key, once it has been checked. Who is refused later is said in the log.
dds::Settings with_keys(dds::Settings settings, const config::Launch& launch,
                        const std::optional<security::Member>& member);

/// A folder of keys for one run on one host: of every region, and of one of each role.
void make_keys_for_one_host(const std::filesystem::path& folder, std::size_t regions);

}  // namespace aurasim::cli
