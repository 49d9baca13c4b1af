// Access rights at the web server. No sockets in here, and time is passed in.
//
// A token is accepted in a header only. A client that has shown it gets a cookie with another secret, drawn at the
// start: it expires with the overseer, and the token cannot be derived from it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/token_bucket.h"
#include "overseer/web_settings.h"

namespace aurasim::overseer {

/// Rights of a client; each level includes those before it.
enum class Standing : std::uint8_t {
  kStranger,  ///< may load the page and show a token
  kViewer,    ///< may look at the world
  kOperator,  ///< may change the world
};

/// Parts of a request that identify the client. Empty: not there.
struct Credentials {
  std::string_view authorization;
  std::string_view cookies;
};

/// A refusal with its HTTP status.
struct Refusal {
  unsigned status = 403;
  std::string why;
};

/// Used by one thread, but for wrong_tokens().
class WebAccess {
 public:
  using Clock = std::chrono::steady_clock;

  /// `settings.port` must be the port that the server listens on.
  explicit WebAccess(const WebSettings& settings);

  /// Returns why a request with these headers, on a connection to `local_address`, is refused; empty: it is allowed.
  std::string why_not(std::string_view host, std::string_view origin, std::string_view local_address) const;

  /// Returns the client's rights, or a refusal. After several wrong tokens from one address its next ones are refused
  /// unread for a while; clients with a cookie are not affected.
  std::variant<Standing, Refusal> standing_of(const std::string& address, const Credentials& credentials,
                                              Clock::time_point now);
  /// Value for Set-Cookie. Empty for kStranger.
  std::string cookie(Standing standing) const;
  std::uint64_t wrong_tokens() const { return wrong_tokens_; }

 private:
  bool is_open() const { return token_.empty() && view_token_.empty(); }
  bool is_meant(std::string_view host, std::string_view local_address) const;
  core::TokenBucket& guesses_of(const std::string& address, Clock::time_point now);

  bool has_tls_;
  std::vector<std::string> names_;
  std::string token_, view_token_;
  std::string cookie_name_;
  std::string session_, view_session_;  ///< secrets in the cookies
  std::map<std::string, core::TokenBucket> guesses_;
  std::atomic<std::uint64_t> wrong_tokens_ = 0;
};

}  // namespace aurasim::overseer
