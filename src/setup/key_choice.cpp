#include "setup/key_choice.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace aurasim::setup {
namespace {

constexpr std::chrono::days kOneRun{30};

/// Turns a fault of keys into an error of the user's input, because the user has given the keys.
template <class Work>
auto with_bad_keys_told(Work&& work) {
  try {
    return work();
  } catch (const security::BadKeys& error) {
    throw config::BadConfig({error.what()});
  }
}

std::string list_of(const Roles& roles) {
  std::vector<std::string> names;
  for (const security::Role role : roles) names.emplace_back(name_of(role));
  return fmt::format("{}", fmt::join(names, ", "));
}

security::Member member_named(const security::KeyStore& store, const std::string& name) {
  if (auto member = store.find(name)) return *member;
  store.files_of(name);  // says who is there
  throw security::BadKeys(fmt::format("{}: found no certificate of '{}'", store.folder().string(), name));
}

}  // namespace

std::optional<security::Member> member_for(const config::Launch& launch, const std::string& as, const Roles& roles) {
  if (launch.dds.security.empty()) return std::nullopt;
  return with_bad_keys_told([&]() -> std::optional<security::Member> {
    const security::KeyStore store(launch.dds.security);
    if (as.empty()) {
      if (auto member = store.first_with(roles)) return member;
      throw security::BadKeys(fmt::format("{}: found no key for this, allowed: one of these roles: {}",
                                          store.folder().string(), list_of(roles)));
    }
    const security::Member member = member_named(store, as);
    if (std::ranges::find(roles, member.role) != roles.end()) return member;
    throw security::BadKeys(
        fmt::format("--as: found {} of role {}, allowed for this: {}", as, name_of(member.role), list_of(roles)));
  });
}

std::optional<security::Member> member_for_node(const config::Launch& launch, const std::string& as,
                                                core::RegionId region) {
  if (launch.dds.security.empty()) return std::nullopt;
  return with_bad_keys_told([&]() -> std::optional<security::Member> {
    const security::KeyStore store(launch.dds.security);
    const std::string own = security::member_of_region(core::value_of(region)).name;
    std::optional<security::Member> member = as.empty() ? store.find(own) : member_named(store, as);
    if (!member) member = store.first_with({security::Role::kSpare});
    if (!member) member = member_named(store, own);  // says who is there
    if (member->role == security::Role::kSpare || member->name == own) return member;
    throw security::BadKeys(fmt::format("--as: found {} of role {}, allowed for the node of region {}: {}, or a spare",
                                        member->name, name_of(member->role), core::value_of(region), own));
  });
}

std::string why_no_hub(const config::Launch& launch) {
  if (launch.dds.security.empty()) return {};
  return with_bad_keys_told([&]() -> std::string {
    const security::KeyStore store(launch.dds.security);
    const std::string folder = store.folder().string();
    if (!store.first_with({security::Role::kHub})) {
      return fmt::format("{0} has no key for one: `aurasim keys add {0} hub-1 --role hub` makes it", folder);
    }
    std::vector<std::string> old;
    for (const security::Member& member : store.members()) {
      if (!store.has_all_rights(member.name)) old.push_back(member.name);
    }
    if (old.empty()) return {};
    return fmt::format(
        "keys in {} are from a version that had no hubs with keys: `aurasim keys rotate {} {}` makes new ones", folder,
        folder, fmt::join(old, " "));
  });
}

dds::Settings with_keys(dds::Settings settings, const config::Launch& launch,
                        const std::optional<security::Member>& member) {
  if (!member) return settings;
  settings.keys = with_bad_keys_told([&] { return security::KeyStore(launch.dds.security).files_of(member->name); });
  settings.report_refusal = [](const std::string& what) { spdlog::warn("{}", what); };
  return settings;
}

void make_keys_for_one_host(const std::filesystem::path& folder, std::size_t regions) {
  with_bad_keys_told([&] {
    security::KeyStore store = security::KeyStore::create(folder, kOneRun);
    for (std::uint32_t r = 0; r < regions; ++r) store.add(security::member_of_region(r), kOneRun);
    for (const security::Role role : {security::Role::kSpare, security::Role::kViewer, security::Role::kOperator,
                                      security::Role::kRecorder, security::Role::kHub}) {
      store.add({name_of(role), role}, kOneRun);
    }
  });
}

}  // namespace aurasim::setup
