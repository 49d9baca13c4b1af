// Makes and checks keys, certificates, revocations and signed texts, all as PEM, with OpenSSL, as DDS-Security needs
// them. Elliptic curve P-256, SHA-256. Every failure throws BadKeys.
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

/// Subject of a certificate. As text in DDS-Security's form (RFC 2253): CN=region-2,OU=region,O=aurasim.
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

/// Content of a certificate.
struct Certificate {
  Subject subject;
  Validity valid;
  std::string serial;  ///< hexadecimal
};

/// Makes an authority, whose certificate is signed by itself.
KeyPair make_authority(const Subject& subject, const Validity& valid);
KeyPair issue(const KeyPair& authority, const Subject& subject, const Validity& valid);
/// Reads a certificate. Throws BadKeys if it is no certificate, or not of the kind that this program makes.
Certificate read_certificate(const std::string& certificate);
bool key_fits(const std::string& key, const std::string& certificate);
/// True when the authority has signed the certificate, even if it is out of date.
bool is_signed_by(const std::string& certificate, const std::string& authority_certificate);

/// Makes a list of revoked certificates, valid as long as the authority.
std::string make_revocations(const KeyPair& authority, const std::vector<std::string>& serials);
/// Returns the serial numbers in a list of revocations. Throws BadKeys if the authority has not signed the list.
std::vector<std::string> read_revocations(const std::string& list, const std::string& authority_certificate);

/// Signs a text as S/MIME, as governance and permissions are signed.
std::string sign(const KeyPair& authority, const std::string& text);
/// Returns the text without its signature. Throws BadKeys if the authority has not signed it.
std::string verified(const std::string& signed_text, const std::string& authority_certificate);

}  // namespace aurasim::security
