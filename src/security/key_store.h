// The folder with a run's keys.
//
//   DIR/identity_ca.pem         the authority that signs the names' certificates
//       permissions_ca.pem      the authority that signs permissions and governance
//       governance.p7s          the rules for all participants, signed
//       crl.pem                 the revoked certificates, signed
//       names/NAME/key.pem      the private key of NAME; readable by its owner only
//                  certificate.pem
//                  permissions.p7s   what NAME may publish and read, signed
//       issued.txt              every certificate so far: serial number, name, role
//       private/                the private keys of the two authorities: they stay where the store was made
//
// A host gets all files except issued.txt and private/, and of names/ only its own: `keys pack` puts these into one
// file. They are a folder of keys, too, but no name can be added to it.
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

/// One holder of a key: a name with its role.
struct Member {
  std::string name;
  Role role = Role::kViewer;
  std::uint32_t region = 0;  ///< region of a Role::kRegion

  std::string subject() const;
};

/// Returns the member of a region, e.g. "region-3".
Member member_of_region(std::uint32_t region);

struct MemberState {
  std::string name;
  std::string role;
  std::optional<Validity> valid;
  bool has_all_rights = true;  ///< false: the key was made by an earlier version, and its role has more rights today
  std::string problem;         ///< empty: none
};

/// A key store. Every failure is a BadKeys that names the file, what was found, and what is allowed.
class KeyStore {
 public:
  using Days = std::chrono::days;

  /// Makes a store in a folder that is not there yet.
  static KeyStore create(const std::filesystem::path& folder, Days authorities_valid);
  /// Opens a store, or the part of one that a host has been given.
  explicit KeyStore(std::filesystem::path folder);

  /// Makes a key for a new name, of letters, digits, - and _.
  void add(const Member& member, Days valid);
  void add(const Member& member, const Validity& valid);
  /// Makes new keys for a name. Its former keys stay valid until they expire.
  void rotate(const std::string& name, Days valid);
  /// Revokes all certificates that `name` was ever given. Other processes accept them until they have the new crl.pem
  /// and are restarted.
  void revoke(const std::string& name);

  /// All members, in order of their names.
  std::vector<Member> members() const;
  std::optional<Member> find(const std::string& name) const;
  /// Returns a member with the first of these roles that any member has. If several have it: the first by name.
  std::optional<Member> first_with(const std::vector<Role>& roles) const;
  /// Returns the files that a process of that name needs, after checking that they are there, private, of this store,
  /// in date and not revoked.
  KeyFiles files_of(const std::string& name) const;
  /// True if the signed permissions of `name` have all rights that its role has today. Keys of earlier versions may
  /// lack some.
  bool has_all_rights(const std::string& name) const;
  /// Checks every name and returns its state.
  std::vector<MemberState> check() const;
  /// Files that a host needs to run processes of these names, relative to the folder.
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
