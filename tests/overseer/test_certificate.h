// Certificates and keys for tests, made by OpenSSL when they are needed.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

namespace aurasim::overseer::testing {

class TestCertificate {
 public:
  /// Signed by itself, for so many days from now on. `names` as OpenSSL reads them: "DNS:localhost,IP:127.0.0.1".
  explicit TestCertificate(const std::string& names, int days = 1) {
    X509* const x = certificate_.get();
    X509_set_version(x, X509_VERSION_3);
    ASN1_INTEGER_set(X509_get_serialNumber(x), 1);
    X509_gmtime_adj(X509_getm_notBefore(x), -2L * 24 * 3600);
    X509_gmtime_adj(X509_getm_notAfter(x), days * 24L * 3600);
    X509_set_pubkey(x, key_.get());
    X509_NAME* const subject = X509_get_subject_name(x);
    X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("test"), -1, -1, 0);
    X509_set_issuer_name(x, subject);
    X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, names.c_str());
    X509_add_ext(x, extension, -1);
    X509_EXTENSION_free(extension);
    X509_sign(x, key_.get(), EVP_sha256());
  }

  void write_certificate(const std::filesystem::path& file) const {
    const File opened(std::fopen(file.c_str(), "w"), &std::fclose);
    PEM_write_X509(opened.get(), certificate_.get());
  }
  /// That only its owner may read. A passphrase encrypts it.
  void write_key(const std::filesystem::path& file, const std::string& passphrase = {}) const {
    {
      const File opened(std::fopen(file.c_str(), "w"), &std::fclose);
      PEM_write_PrivateKey(opened.get(), key_.get(), passphrase.empty() ? nullptr : EVP_aes_128_cbc(),
                           reinterpret_cast<const unsigned char*>(passphrase.data()),
                           static_cast<int>(passphrase.size()), nullptr, nullptr);
    }
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key_{EVP_EC_gen("P-256"), &EVP_PKEY_free};
  std::unique_ptr<X509, void (*)(X509*)> certificate_{X509_new(), &X509_free};
};

}  // namespace aurasim::overseer::testing
