#include "security/key_store.h"

#include <algorithm>
#include <charconv>
#include <random>
#include <sstream>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include "security/files.h"
#include "security/governance.h"

namespace aurasim::security {
namespace {

constexpr const char* kIdentity = "identity_ca";
constexpr const char* kPermissions = "permissions_ca";
constexpr const char* kGovernance = "governance.p7s";
constexpr const char* kRevocations = "crl.pem";
constexpr const char* kIssued = "issued.txt";
constexpr const char* kOrganisation = "aurasim";
constexpr std::size_t kLongestName = 48;
/// Certificates are valid from this long before now, so that hosts whose clocks are slightly late accept a new one at
/// once.
constexpr std::chrono::minutes kClocksDiffer{5};

Seconds now() { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); }

Validity from_now(KeyStore::Days days) { return {now() - kClocksDiffer, now() + days}; }

std::string date(Seconds at) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(std::chrono::system_clock::to_time_t(at)));
}

void check_name(const std::string& name) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || name.size() > kLongestName || name[0] == '-' || !std::ranges::all_of(name, is_allowed)) {
    throw BadKeys(fmt::format("found the name '{}', allowed: up to {} letters, digits, - and _", name, kLongestName));
  }
}

/// Returns the N in "region-N".
std::optional<std::uint32_t> region_in(const std::string& name) {
  constexpr std::string_view kPrefix = "region-";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  std::uint32_t region = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + kPrefix.size(), end, region);
  return error == std::errc{} && rest == end ? std::optional(region) : std::nullopt;
}

Subject subject_of(const Member& member) { return {member.name, name_of(member.role), kOrganisation}; }

/// Names an authority after its store, so that Fast DDS can report which authority it does not know.
Subject subject_of_authority(const char* what, const std::string& store) {
  return {fmt::format("{} of {}", what, store), "", kOrganisation};
}

/// Runs `work`, and puts the file's name in front of the message of a BadKeys.
template <class Work>
auto about(const std::filesystem::path& file, Work&& work) {
  try {
    return work(read_key_file(file));
  } catch (const BadKeys& error) {
    const std::string what = error.what();
    if (what.starts_with(file.string())) throw;
    throw BadKeys(fmt::format("{}: {}", file.string(), what));
  }
}

Member member_in(const std::filesystem::path& certificate_file) {
  const Certificate certificate = about(certificate_file, read_certificate);
  const std::optional<Role> role = role_named(certificate.subject.unit);
  const std::optional<std::uint32_t> region = region_in(certificate.subject.name);
  if (!role || (*role == Role::kRegion) != region.has_value()) {
    throw BadKeys(fmt::format("{}: found a certificate of {}, allowed: one that `aurasim keys` has made",
                              certificate_file.string(), certificate.subject.text()));
  }
  return {certificate.subject.name, *role, region.value_or(0)};
}

void check_date(const std::filesystem::path& file, const Validity& valid) {
  const Seconds at = now();
  if (at < valid.from) {
    throw BadKeys(fmt::format("{}: valid from {} on, and this host's clock says {}: is it right?", file.string(),
                              date(valid.from), date(at)));
  }
  if (at > valid.until) {
    throw BadKeys(
        fmt::format("{}: expired: valid until {}, and this host's clock says {}; `aurasim keys rotate` makes "
                    "new ones",
                    file.string(), date(valid.until), date(at)));
  }
}

}  // namespace

std::string Member::subject() const { return subject_of(*this).text(); }

Member member_of_region(std::uint32_t region) { return {fmt::format("region-{}", region), Role::kRegion, region}; }

KeyStore KeyStore::create(const std::filesystem::path& folder, Days authorities_valid) {
  make_key_folder(folder);
  make_key_folder(folder / "private");
  make_key_folder(folder / "names");
  const std::string id = fmt::format("{:08x}", std::random_device()());
  const Validity valid = from_now(authorities_valid);
  for (const char* which : {kIdentity, kPermissions}) {
    const KeyPair authority = make_authority(subject_of_authority(which, id), valid);
    write_key_file(folder / "private" / fmt::format("{}.key.pem", which), authority.key, Secrecy::kPrivate);
    write_key_file(folder / fmt::format("{}.pem", which), authority.certificate, Secrecy::kPublic);
  }
  KeyStore store(folder);
  write_key_file(folder / kRevocations, make_revocations(store.authority(kIdentity), {}), Secrecy::kPublic);
  write_key_file(folder / kGovernance, sign(store.authority(kPermissions), governance_document()), Secrecy::kPublic);
  write_key_file(folder / kIssued, "", Secrecy::kPublic);
  return store;
}

KeyStore::KeyStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  if (std::filesystem::is_regular_file(folder_ / "identity_ca.pem", error)) return;
  throw BadKeys(
      fmt::format("{}: found no keys (no identity_ca.pem), allowed: a folder made by `aurasim keys init`, or "
                  "what `aurasim keys pack` has packed of it, unpacked",
                  folder_.string()));
}

std::filesystem::path KeyStore::folder_of(const std::string& name) const { return folder_ / "names" / name; }

KeyPair KeyStore::authority(const char* which) const {
  const std::filesystem::path key = folder_ / "private" / fmt::format("{}.key.pem", which);
  std::error_code error;
  if (!std::filesystem::exists(key, error)) {
    throw BadKeys(
        fmt::format("{}: is not there: this is what a host has been given of a store; keys are made where the "
                    "store is",
                    key.string()));
  }
  check_is_private(key);
  return {read_key_file(key), read_key_file(folder_ / fmt::format("{}.pem", which))};
}

void KeyStore::add(const Member& member, Days valid) { add(member, from_now(valid)); }

void KeyStore::add(const Member& member, const Validity& valid) {
  check_name(member.name);
  if ((member.role == Role::kRegion) != region_in(member.name).has_value()) {
    throw BadKeys(
        fmt::format("found the name '{}' for a {}, allowed: region-N for the node of a region, and for nobody "
                    "else",
                    member.name, name_of(member.role)));
  }
  if (std::filesystem::exists(folder_of(member.name))) {
    throw BadKeys(
        fmt::format("{}: is there already; `aurasim keys rotate` makes it new keys", folder_of(member.name).string()));
  }
  write_member(member, valid);
}

void KeyStore::write_member(const Member& member, const Validity& valid) {
  const Subject subject = subject_of(member);
  const KeyPair identity = authority(kIdentity);
  const Validity of_authority = about(folder_ / "identity_ca.pem", read_certificate).valid;
  const Validity both{std::max(valid.from, of_authority.from), std::min(valid.until, of_authority.until)};
  const KeyPair pair = issue(identity, subject, both);
  const std::string permissions =
      sign(authority(kPermissions), permissions_document(subject, both, grants_of(member.role, member.region)));
  // Listed before it can be used; otherwise it could not be revoked.
  write_key_file(folder_ / kIssued,
                 fmt::format("{}{} {} {}\n", read_key_file(folder_ / kIssued),
                             read_certificate(pair.certificate).serial, member.name, name_of(member.role)),
                 Secrecy::kPublic);
  const std::filesystem::path folder = folder_of(member.name);
  if (!std::filesystem::exists(folder)) make_key_folder(folder);
  write_key_file(folder / "key.pem", pair.key, Secrecy::kPrivate);
  write_key_file(folder / "certificate.pem", pair.certificate, Secrecy::kPublic);
  write_key_file(folder / "permissions.p7s", permissions, Secrecy::kPublic);
}

void KeyStore::rotate(const std::string& name, Days valid) {
  const std::optional<Member> member = find(name);
  if (!member) throw BadKeys(fmt::format("{}: is not there", folder_of(name).string()));
  write_member(*member, from_now(valid));
}

std::vector<std::string> KeyStore::serials_of(const std::string& name) const {
  std::vector<std::string> serials;
  std::istringstream in(read_key_file(folder_ / kIssued));
  for (std::string serial, who, role; in >> serial >> who >> role;) {
    if (who == name) serials.push_back(serial);
  }
  return serials;
}

void KeyStore::revoke(const std::string& name) {
  check_name(name);
  const std::vector<std::string> fresh = serials_of(name);
  if (fresh.empty()) throw BadKeys(fmt::format("{}: has no certificate of '{}'", (folder_ / kIssued).string(), name));
  const KeyPair identity = authority(kIdentity);
  std::vector<std::string> serials = about(
      folder_ / kRevocations, [&](const std::string& list) { return read_revocations(list, identity.certificate); });
  for (const std::string& serial : fresh) {
    if (std::ranges::find(serials, serial) == serials.end()) serials.push_back(serial);
  }
  write_key_file(folder_ / kRevocations, make_revocations(identity, serials), Secrecy::kPublic);
}

std::vector<std::string> KeyStore::names() const {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "names", error)) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

std::vector<Member> KeyStore::members() const {
  std::vector<Member> members;
  for (const std::string& name : names()) {
    if (const std::optional<Member> member = find(name)) members.push_back(*member);
  }
  return members;
}

std::optional<Member> KeyStore::find(const std::string& name) const {
  check_name(name);
  const std::filesystem::path certificate = folder_of(name) / "certificate.pem";
  std::error_code error;
  if (!std::filesystem::exists(certificate, error)) return std::nullopt;
  Member member = member_in(certificate);
  if (member.name == name) return member;
  throw BadKeys(fmt::format("{}: found a certificate of {}", certificate.string(), member.subject()));
}

std::optional<Member> KeyStore::first_with(const std::vector<Role>& roles) const {
  const std::vector<Member> all = members();
  for (const Role role : roles) {
    const auto found = std::ranges::find(all, role, &Member::role);
    if (found != all.end()) return *found;
  }
  return std::nullopt;
}

KeyFiles KeyStore::files_of(const std::string& name) const {
  check_name(name);
  const std::filesystem::path own = folder_of(name);
  if (!std::filesystem::is_directory(own)) {
    throw BadKeys(
        fmt::format("{}: found no key of '{}', there are: {}", folder_.string(), name, fmt::join(names(), ", ")));
  }
  KeyFiles files{folder_ / "identity_ca.pem", own / "certificate.pem",        own / "key.pem",
                 folder_ / kRevocations,      folder_ / "permissions_ca.pem", folder_ / kGovernance,
                 own / "permissions.p7s"};
  check_is_private(files.key);
  const std::string identity = read_key_file(files.identity_ca);
  const std::string permissions_ca = read_key_file(files.permissions_ca);
  for (const auto& file : {files.identity_ca, files.permissions_ca, files.certificate}) {
    check_date(file, about(file, read_certificate).valid);
  }
  find(name);  // checks that the certificate belongs to the name
  const std::string certificate = read_key_file(files.certificate);
  if (!is_signed_by(certificate, identity)) {
    throw BadKeys(fmt::format("{}: not signed by {}", files.certificate.string(), files.identity_ca.string()));
  }
  if (!about(files.key, [&](const std::string& key) { return key_fits(key, certificate); })) {
    throw BadKeys(fmt::format("{}: {} is not its private key", files.certificate.string(), files.key.string()));
  }
  const std::vector<std::string> revoked =
      about(files.revocations, [&](const std::string& list) { return read_revocations(list, identity); });
  if (std::ranges::find(revoked, read_certificate(certificate).serial) != revoked.end()) {
    throw BadKeys(fmt::format("{}: revoked", files.certificate.string()));
  }
  about(files.governance, [&](const std::string& text) { verified(text, permissions_ca); });
  about(files.permissions, [&](const std::string& text) { verified(text, permissions_ca); });
  return files;
}

bool KeyStore::has_all_rights(const std::string& name) const {
  const std::optional<Member> member = find(name);
  if (!member) return false;
  const std::string permissions_ca = read_key_file(folder_ / "permissions_ca.pem");
  const std::string document = about(folder_of(name) / "permissions.p7s",
                                     [&](const std::string& text) { return verified(text, permissions_ca); });
  return has_rules(document, grants_of(member->role, member->region));
}

std::vector<MemberState> KeyStore::check() const {
  std::vector<MemberState> states;
  for (const std::string& name : names()) {
    MemberState state;
    state.name = name;
    try {
      const Certificate certificate = about(folder_of(name) / "certificate.pem", read_certificate);
      state.role = certificate.subject.unit;
      state.valid = certificate.valid;
      files_of(name);
      state.has_all_rights = has_all_rights(name);
    } catch (const BadKeys& error) {
      state.problem = error.what();
    }
    states.push_back(std::move(state));
  }
  return states;
}

std::vector<std::filesystem::path> KeyStore::files_for_host(const std::vector<std::string>& names) const {
  std::vector<std::filesystem::path> files = {"identity_ca.pem", "permissions_ca.pem", kGovernance, kRevocations};
  for (const std::string& name : names) {
    files_of(name);  // checks the keys, which would otherwise be refused on that host
    for (const char* file : {"certificate.pem", "key.pem", "permissions.p7s"}) {
      files.push_back(std::filesystem::path("names") / name / file);
    }
  }
  return files;
}

}  // namespace aurasim::security
