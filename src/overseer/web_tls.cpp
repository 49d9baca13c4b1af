#include "overseer/web_tls.h"

#include <array>
#include <memory>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <spdlog/spdlog.h>

#include "overseer/tls_files.h"

namespace aurasim::overseer {
namespace {

namespace ssl = boost::asio::ssl;
namespace fs = std::filesystem;

constexpr const char* kCiphersOfTls12 = "ECDHE+AESGCM:ECDHE+CHACHA20";

/// Returns OpenSSL's first error; later ones only follow from it.
std::string why_openssl_failed() {
  const unsigned long error = ERR_peek_error();
  ERR_clear_error();
  const char* const reason = ERR_reason_error_string(error);
  return reason == nullptr ? "it cannot be used" : reason;
}

[[noreturn]] void refuse(const char* key, const fs::path& file, const std::string& why) {
  throw BadTls(key, fmt::format("found {}, allowed: a PEM file ({})", file.string(), why));
}

void check_file(const char* key, const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) refuse(key, file, error ? error.message() : "there is none");
  if (!fs::is_regular_file(status)) refuse(key, file, "this is no file");
}

/// Checks that only the user that runs the overseer, and a group that is meant to, may read the key.
void check_secrecy(const fs::path& key) {
  std::error_code ignored;
  if ((fs::status(key, ignored).permissions() & fs::perms::others_all) != fs::perms::none)
    refuse("key", key, fmt::format("everybody may read it: chmod o= {}", key.string()));
}

void warn_of_age(ssl::context& context, const fs::path& file) {
  const X509* const certificate = SSL_CTX_get0_certificate(context.native_handle());
  if (X509_cmp_current_time(X509_get0_notAfter(certificate)) < 0)
    spdlog::warn("{}: the certificate has expired: browsers will refuse it", file.string());
  if (X509_cmp_current_time(X509_get0_notBefore(certificate)) > 0)
    spdlog::warn("{}: the certificate is not valid yet, or this clock is wrong", file.string());
}

std::string address_text(const ASN1_OCTET_STRING& address) {
  const int length = ASN1_STRING_length(&address);
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (length == 4) ::inet_ntop(AF_INET, ASN1_STRING_get0_data(&address), text.data(), text.size());
  if (length == 16) ::inet_ntop(AF_INET6, ASN1_STRING_get0_data(&address), text.data(), text.size());
  return length == 16 ? fmt::format("[{}]", text.data()) : text.data();
}

}  // namespace

ssl::context make_tls_context(const config::Tls& tls) {
  check_file("certificate", tls.certificate);
  check_file("key", tls.key);
  check_secrecy(tls.key);
  ssl::context context(ssl::context::tls_server);
  SSL_CTX* const native = context.native_handle();
  SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  SSL_CTX_set_cipher_list(native, kCiphersOfTls12);
  SSL_CTX_set_options(native, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_mode(native, SSL_MODE_RELEASE_BUFFERS);                    // many idle connections need little memory
  SSL_CTX_set_session_cache_mode(native, SSL_SESS_CACHE_OFF);            // session tickets suffice
  context.set_password_callback([](auto...) { return std::string(); });  // instead of asking at the terminal
  ERR_clear_error();
  if (SSL_CTX_use_certificate_chain_file(native, tls.certificate.c_str()) != 1)
    refuse("certificate", tls.certificate, why_openssl_failed());
  if (SSL_CTX_use_PrivateKey_file(native, tls.key.c_str(), SSL_FILETYPE_PEM) != 1)
    refuse("key", tls.key, why_openssl_failed());
  if (SSL_CTX_check_private_key(native) != 1) refuse("key", tls.key, "it is not that of the certificate");
  warn_of_age(context, tls.certificate);
  return context;
}

void check_tls(const config::Tls& tls) { make_tls_context(tls); }

std::vector<std::string> names_of_certificate(ssl::context& context) {
  std::vector<std::string> names;
  X509* const certificate = SSL_CTX_get0_certificate(context.native_handle());
  const std::unique_ptr<GENERAL_NAMES, decltype(&GENERAL_NAMES_free)> found(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)),
      &GENERAL_NAMES_free);
  for (int i = 0; found && i < sk_GENERAL_NAME_num(found.get()); ++i) {
    const GENERAL_NAME* const name = sk_GENERAL_NAME_value(found.get(), i);
    if (name->type == GEN_DNS)
      names.emplace_back(reinterpret_cast<const char*>(ASN1_STRING_get0_data(name->d.dNSName)),
                         static_cast<std::size_t>(ASN1_STRING_length(name->d.dNSName)));
    if (name->type == GEN_IPADD) names.push_back(address_text(*name->d.iPAddress));
  }
  return names;
}

}  // namespace aurasim::overseer
