// Certificate and key of the web server, as files. OpenSSL stays behind this header.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "config/launch.h"

namespace aurasim::overseer {

/// A file of overseer.tls cannot be used.
class BadTls : public std::runtime_error {
 public:
  /// `key`: the key of the launch file, "certificate" or "key".
  BadTls(std::string key, const std::string& what) : std::runtime_error(what), key_(std::move(key)) {}
  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

/// Throws BadTls when a file cannot be read, is not what it should be, or the two do not fit; also when everybody may
/// read the key.
void check_tls(const config::Tls& tls);

}  // namespace aurasim::overseer
