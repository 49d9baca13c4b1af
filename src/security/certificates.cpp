#include "security/certificates.h"

#include <ctime>
#include <memory>

#include <fmt/format.h>
#include <openssl/asn1.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "security/bad_keys.h"

namespace aurasim::security {
namespace {

template <auto kFree>
struct FreeWith {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
template <class T, auto kFree>
using Owned = std::unique_ptr<T, FreeWith<kFree>>;

using Bio = Owned<BIO, BIO_free_all>;
using Key = Owned<EVP_PKEY, EVP_PKEY_free>;
using X509Ptr = Owned<X509, X509_free>;
using CrlPtr = Owned<X509_CRL, X509_CRL_free>;
using NamePtr = Owned<X509_NAME, X509_NAME_free>;
using BigNumber = Owned<BIGNUM, BN_free>;
using Integer = Owned<ASN1_INTEGER, ASN1_INTEGER_free>;
using Time = Owned<ASN1_TIME, ASN1_TIME_free>;
using Pkcs7 = Owned<PKCS7, PKCS7_free>;
using Store = Owned<X509_STORE, X509_STORE_free>;

constexpr int kSmimeFlags = PKCS7_TEXT | PKCS7_DETACHED;

[[noreturn]] void fail(const char* doing) {
  const unsigned long error = ERR_peek_last_error();
  ERR_clear_error();
  const char* why = error == 0 ? nullptr : ERR_reason_error_string(error);
  throw BadKeys(fmt::format("cannot {}: {}", doing, why == nullptr ? "OpenSSL does not say why" : why));
}

template <class T>
T checked(T result, const char* doing) {
  if (!result) fail(doing);
  return result;
}

void require(bool well, const char* doing) {
  if (!well) fail(doing);
}

/// Checks that `result` was read from `text`; throws BadKeys if not.
template <class T>
T found_in(const std::string& text, T result, const char* what) {
  if (result) return result;
  const bool is_empty = text.find_first_not_of(" \t\r\n") == std::string::npos;
  const unsigned long error = ERR_peek_last_error();
  const char* const reason = ERR_reason_error_string(error);
  ERR_clear_error();
  const std::string why = is_empty || reason == nullptr ? "" : fmt::format(" (OpenSSL: {})", reason);
  throw BadKeys(fmt::format("found {}{}, allowed: {}; `aurasim keys` makes it anew (rotate NAME, or init)",
                            is_empty ? "an empty file" : "something else", why, what));
}

Bio memory() { return Bio(checked(BIO_new(BIO_s_mem()), "take memory")); }
Bio memory_of(const std::string& text) {
  return Bio(checked(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), "take memory"));
}
std::string text_in(const Bio& bio) {
  char* begin = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &begin);
  return {begin, static_cast<std::size_t>(size)};
}

Key key_in(const std::string& pem) {
  return Key(found_in(pem, PEM_read_bio_PrivateKey(memory_of(pem).get(), nullptr, nullptr, nullptr),
                      "a private key in PEM format"));
}
X509Ptr certificate_in(const std::string& pem) {
  return X509Ptr(
      found_in(pem, PEM_read_bio_X509(memory_of(pem).get(), nullptr, nullptr, nullptr), "a certificate in PEM format"));
}
std::string pem_of(EVP_PKEY* key) {
  const Bio out = memory();
  require(PEM_write_bio_PrivateKey(out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1, "write the key");
  return text_in(out);
}
std::string pem_of(X509* certificate) {
  const Bio out = memory();
  require(PEM_write_bio_X509(out.get(), certificate) == 1, "write the certificate");
  return text_in(out);
}

Time asn1_time(Seconds at) {
  return Time(checked(ASN1_TIME_set(nullptr, std::chrono::system_clock::to_time_t(at)), "write a time"));
}
Seconds seconds_of(const ASN1_TIME* at) {
  std::tm broken_down{};
  require(ASN1_TIME_to_tm(at, &broken_down) == 1, "read a time");
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::from_time_t(::timegm(&broken_down)));
}

std::string hex_of(const ASN1_INTEGER* number) {
  const BigNumber big(checked(ASN1_INTEGER_to_BN(number, nullptr), "read a serial number"));
  char* text = checked(BN_bn2hex(big.get()), "read a serial number");
  std::string hex = text;
  OPENSSL_free(text);
  return hex;
}
Integer integer_of(const std::string& hex) {
  BIGNUM* number = nullptr;
  require(BN_hex2bn(&number, hex.c_str()) != 0, "read a serial number");
  const BigNumber owner(number);
  return Integer(checked(BN_to_ASN1_INTEGER(number, nullptr), "write a serial number"));
}

/// Draws a serial number at random, so that no counter is needed to keep them different.
Integer random_serial() {
  const BigNumber number(checked(BN_new(), "take memory"));
  require(BN_rand(number.get(), 127, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1, "draw a serial number");
  return Integer(checked(BN_to_ASN1_INTEGER(number.get(), nullptr), "write a serial number"));
}

void add_entry(X509_NAME* name, int what, const std::string& text) {
  if (text.empty()) return;
  require(X509_NAME_add_entry_by_NID(name, what, MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(text.data()),
                                     static_cast<int>(text.size()), -1, 0) == 1,
          "write a name");
}
NamePtr name_of(const Subject& subject) {
  NamePtr name(checked(X509_NAME_new(), "take memory"));
  add_entry(name.get(), NID_organizationName, subject.organisation);
  add_entry(name.get(), NID_organizationalUnitName, subject.unit);
  add_entry(name.get(), NID_commonName, subject.name);
  return name;
}
std::string entry_of(X509_NAME* name, int what) {
  const int length = X509_NAME_get_text_by_NID(name, what, nullptr, 0);
  if (length <= 0) return {};
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  X509_NAME_get_text_by_NID(name, what, text.data(), static_cast<int>(text.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

void add_extension(X509* certificate, X509* issuer, int what, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Owned<X509_EXTENSION, X509_EXTENSION_free> extension(
      checked(X509V3_EXT_conf_nid(nullptr, &context, what, value), "write an extension"));
  require(X509_add_ext(certificate, extension.get(), -1) == 1, "write an extension");
}

Key new_key() { return Key(checked(EVP_EC_gen("P-256"), "make a key")); }

/// Makes a certificate without extensions and signature.
X509Ptr begin_certificate(EVP_PKEY* key, const Subject& subject, const Validity& valid) {
  X509Ptr certificate(checked(X509_new(), "take memory"));
  require(X509_set_version(certificate.get(), X509_VERSION_3) == 1 &&
              X509_set_serialNumber(certificate.get(), random_serial().get()) == 1 &&
              X509_set_subject_name(certificate.get(), name_of(subject).get()) == 1 &&
              X509_set1_notBefore(certificate.get(), asn1_time(valid.from).get()) == 1 &&
              X509_set1_notAfter(certificate.get(), asn1_time(valid.until).get()) == 1 &&
              X509_set_pubkey(certificate.get(), key) == 1,
          "write the certificate");
  return certificate;
}

}  // namespace

std::string Subject::text() const {
  return fmt::format("CN={}{}{},O={}", name, unit.empty() ? "" : ",OU=", unit, organisation);
}

KeyPair make_authority(const Subject& subject, const Validity& valid) {
  const Key key = new_key();
  const X509Ptr certificate = begin_certificate(key.get(), subject, valid);
  X509* self = certificate.get();
  require(X509_set_issuer_name(self, X509_get_subject_name(self)) == 1, "write the certificate");
  add_extension(self, self, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  // digitalSignature is needed, because the authority itself signs the S/MIME documents.
  add_extension(self, self, NID_key_usage, "critical,digitalSignature,keyCertSign,cRLSign");
  add_extension(self, self, NID_subject_key_identifier, "hash");
  require(X509_sign(self, key.get(), EVP_sha256()) > 0, "sign the certificate");
  return {pem_of(key.get()), pem_of(self)};
}

KeyPair issue(const KeyPair& authority, const Subject& subject, const Validity& valid) {
  const Key key = new_key();
  const X509Ptr issuer = certificate_in(authority.certificate);
  const X509Ptr certificate = begin_certificate(key.get(), subject, valid);
  require(X509_set_issuer_name(certificate.get(), X509_get_subject_name(issuer.get())) == 1, "write the certificate");
  add_extension(certificate.get(), issuer.get(), NID_basic_constraints, "critical,CA:FALSE");
  add_extension(certificate.get(), issuer.get(), NID_key_usage, "critical,digitalSignature");
  add_extension(certificate.get(), issuer.get(), NID_authority_key_identifier, "keyid:always");
  require(X509_sign(certificate.get(), key_in(authority.key).get(), EVP_sha256()) > 0, "sign the certificate");
  return {pem_of(key.get()), pem_of(certificate.get())};
}

Certificate read_certificate(const std::string& certificate) {
  const X509Ptr x509 = certificate_in(certificate);
  X509_NAME* name = X509_get_subject_name(x509.get());
  Certificate read;
  read.subject = {entry_of(name, NID_commonName), entry_of(name, NID_organizationalUnitName),
                  entry_of(name, NID_organizationName)};
  read.valid = {seconds_of(X509_get0_notBefore(x509.get())), seconds_of(X509_get0_notAfter(x509.get()))};
  read.serial = hex_of(X509_get0_serialNumber(x509.get()));
  return read;
}

bool key_fits(const std::string& key, const std::string& certificate) {
  const bool fits = X509_check_private_key(certificate_in(certificate).get(), key_in(key).get()) == 1;
  ERR_clear_error();
  return fits;
}

bool is_signed_by(const std::string& certificate, const std::string& authority_certificate) {
  const X509Ptr issuer = certificate_in(authority_certificate);
  const bool is_signed = X509_verify(certificate_in(certificate).get(), X509_get0_pubkey(issuer.get())) == 1;
  ERR_clear_error();
  return is_signed;
}

std::string make_revocations(const KeyPair& authority, const std::vector<std::string>& serials) {
  const X509Ptr issuer = certificate_in(authority.certificate);
  const CrlPtr list(checked(X509_CRL_new(), "take memory"));
  const Time now = asn1_time(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
  require(X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1 &&
              X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(issuer.get())) == 1 &&
              X509_CRL_set1_lastUpdate(list.get(), X509_get0_notBefore(issuer.get())) == 1 &&
              X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(issuer.get())) == 1,
          "write the revocations");
  for (const std::string& serial : serials) {
    Owned<X509_REVOKED, X509_REVOKED_free> revoked(checked(X509_REVOKED_new(), "take memory"));
    require(X509_REVOKED_set_serialNumber(revoked.get(), integer_of(serial).get()) == 1 &&
                X509_REVOKED_set_revocationDate(revoked.get(), now.get()) == 1 &&
                X509_CRL_add0_revoked(list.get(), revoked.get()) == 1,
            "write the revocations");
    (void)revoked.release();  // owned by the list now
  }
  require(X509_CRL_sort(list.get()) == 1 && X509_CRL_sign(list.get(), key_in(authority.key).get(), EVP_sha256()) > 0,
          "sign the revocations");
  const Bio out = memory();
  require(PEM_write_bio_X509_CRL(out.get(), list.get()) == 1, "write the revocations");
  return text_in(out);
}

std::vector<std::string> read_revocations(const std::string& list, const std::string& authority_certificate) {
  const CrlPtr crl(found_in(list, PEM_read_bio_X509_CRL(memory_of(list).get(), nullptr, nullptr, nullptr),
                            "a list of revocations in PEM format"));
  const X509Ptr issuer = certificate_in(authority_certificate);
  require(X509_CRL_verify(crl.get(), X509_get0_pubkey(issuer.get())) == 1, "verify the revocations");
  std::vector<std::string> serials;
  STACK_OF(X509_REVOKED)* revoked = X509_CRL_get_REVOKED(crl.get());
  for (int i = 0; i < sk_X509_REVOKED_num(revoked); ++i) {
    serials.push_back(hex_of(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(revoked, i))));
  }
  return serials;
}

std::string sign(const KeyPair& authority, const std::string& text) {
  const Bio in = memory_of(text);
  const Pkcs7 signature(checked(PKCS7_sign(certificate_in(authority.certificate).get(), key_in(authority.key).get(),
                                           nullptr, in.get(), kSmimeFlags | PKCS7_STREAM),
                                "sign a document"));
  const Bio out = memory();
  require(SMIME_write_PKCS7(out.get(), signature.get(), in.get(), kSmimeFlags | PKCS7_STREAM) == 1,
          "write a signed document");
  return text_in(out);
}

std::string verified(const std::string& signed_text, const std::string& authority_certificate) {
  BIO* content = nullptr;
  const Pkcs7 signature(found_in(signed_text, SMIME_read_PKCS7(memory_of(signed_text).get(), &content),
                                 "a signed document in S/MIME format"));
  const Bio owner(content);
  const X509Ptr authority = certificate_in(authority_certificate);
  const Store store(checked(X509_STORE_new(), "take memory"));
  require(X509_STORE_add_cert(store.get(), authority.get()) == 1, "take memory");
  const Bio out = memory();
  require(PKCS7_verify(signature.get(), nullptr, store.get(), content, out.get(), PKCS7_TEXT) == 1,
          "verify a signed document");
  return text_in(out);
}

}  // namespace aurasim::security
