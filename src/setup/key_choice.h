// Chooses the key that a process uses, of a run's keys (launch key dds.security). Errors throw BadConfig, which ends
// the process with exit code 2. In a run without keys the result is empty.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/settings.h"
#include "security/key_store.h"

namespace aurasim::setup {

using Roles = std::vector<security::Role>;

/// The key named `as`, or else the first key with one of `roles`, best role first. A key of another role is refused.
std::optional<security::Member> member_for(const config::Launch& launch, const std::string& as, const Roles& roles);
/// The region's own key, or else a spare's, which may publish for any region.
std::optional<security::Member> member_for_node(const config::Launch& launch, const std::string& as,
                                                core::RegionId region);

/// Why a run with the keys of `launch` cannot have a hub, and what to do. Empty: it can, or it has no keys.
std::string why_no_hub(const config::Launch& launch);

/// `settings` with the key, once it has been checked. Processes refused later are logged.
dds::Settings with_keys(dds::Settings settings, const config::Launch& launch,
                        const std::optional<security::Member>& member);

/// Makes a folder of keys for one run on one host: a key for every region, and one for each other role.
void make_keys_for_one_host(const std::filesystem::path& folder, std::size_t regions);

}  // namespace aurasim::setup
