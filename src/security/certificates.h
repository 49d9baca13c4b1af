// Keys, certificates, revocations and signed texts, all as PEM: what DDS-Security wants of OpenSSL. Elliptic curve
// P-256, SHA-256. Every failure is a BadKeys.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::security {

using Seconds = std::chrono::sys_seconds;

/// A private key with its certificate.
struct KeyPair {
  std::string key;
  std::string certificate;
};

/// Whose certificate it is. As DDS-Security writes it (RFC 2253): CN=region-2,OU=region,O=aurasim.
struct Subject {
  std::string name;
  std::string unit;
  std::string organisation;

  std::string text() const;
  bool operator==(const Subject&) const = default;
};

struct Validity {
  Seconds from;
  Seconds until;
};

/// What a certificate says.
struct Certificate {
  Subject subject;
  Validity valid;
  std::string serial;  ///< hexadecimal
};

/// One that signs its own certificate.
KeyPair make_authority(const Subject& subject, const Validity& valid);
KeyPair issue(const KeyPair& authority, const Subject& subject, const Validity& valid);
/// Throws BadKeys for what is no certificate, or none of ours.
Certificate read_certificate(const std::string& certificate);
bool key_fits(const std::string& key, const std::string& certificate);
/// Signed by this authority, whatever the date.
bool is_signed_by(const std::string& certificate, const std::string& authority_certificate);

/// A list of revoked certificates, valid as long as the authority.
std::string make_revocations(const KeyPair& authority, const std::vector<std::string>& serials);
/// Throws BadKeys if the authority has not signed the list.
std::vector<std::string> read_revocations(const std::string& list, const std::string& authority_certificate);

/// S/MIME, as governance and permissions are signed.
std::string sign(const KeyPair& authority, const std::string& text);
/// The text. Throws BadKeys if the authority has not signed it.
std::string verified(const std::string& signed_text, const std::string& authority_certificate);

}  // namespace aurasim::security
