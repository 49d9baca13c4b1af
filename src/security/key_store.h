// The folder with a run's keys.
//
//   DIR/identity_ca.pem         whose signature makes a name known
//       permissions_ca.pem      whose signature says who may say what
//       governance.p7s          what holds for everybody, signed
//       crl.pem                 names that are not to be believed any more, signed
//       names/NAME/key.pem      the private key of NAME; for nobody but its owner
//                  certificate.pem
//                  permissions.p7s   what NAME may say and read, signed
//       issued.txt              every certificate so far: serial number, name, role
//       private/                the private keys of the two authorities: they stay where the store was made
//
// A host gets all but the last two, and of names/ only its own: what `keys pack` puts into one file. That is a folder
// of keys, too, from which nobody can be added.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "security/bad_keys.h"
#include "security/certificates.h"
#include "security/key_files.h"
#include "security/permissions.h"

namespace aurasim::security {

/// Who has a key.
struct Member {
  std::string name;
  Role role = Role::kViewer;
  std::uint32_t region = 0;  ///< of Role::kRegion

  std::string subject() const;
};

/// region-3.
Member member_of_region(std::uint32_t region);

struct MemberState {
  std::string name;
  std::string role;
  std::optional<Validity> valid;
  std::string problem;  ///< empty: none
};

/// Every failure is a BadKeys that names the file, what was found, and what is allowed.
class KeyStore {
 public:
  using Days = std::chrono::days;

  /// Makes a store in a folder that is not there yet.
  static KeyStore create(const std::filesystem::path& folder, Days authorities_valid);
  /// A store, or what a host has been given of one.
  explicit KeyStore(std::filesystem::path folder);

  /// Names are of letters, digits, - and _.
  void add(const Member& member, Days valid);
  void add(const Member& member, const Validity& valid);
  /// New keys for a name; what it had is good until it ends.
  void rotate(const std::string& name, Days valid);
  /// All certificates that NAME was ever given. Others believe them until they have the new crl.pem and are started
  /// again.
  void revoke(const std::string& name);

  /// In order of their names.
  std::vector<Member> members() const;
  std::optional<Member> find(const std::string& name) const;
  /// The first of these roles that somebody has; of several with it, the first by name.
  std::optional<Member> first_with(const std::vector<Role>& roles) const;
  /// Everything that a process of that name needs, checked: there, private, of this store, in time, not revoked.
  KeyFiles files_of(const std::string& name) const;
  /// Of every name.
  std::vector<MemberState> check() const;
  /// Relative to the folder: what a host needs of it to be these names.
  std::vector<std::filesystem::path> files_for_host(const std::vector<std::string>& names) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::vector<std::string> names() const;
  std::filesystem::path folder_of(const std::string& name) const;
  KeyPair authority(const char* which) const;
  void write_member(const Member& member, const Validity& valid);
  std::vector<std::string> serials_of(const std::string& name) const;

  std::filesystem::path folder_;
};

}  // namespace aurasim::security
