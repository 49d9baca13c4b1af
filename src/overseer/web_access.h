// Who may ask the web server for what. No sockets in here, and time is passed in.
//
// A token is shown in a header, and only there. Who has shown it is given a cookie that holds another secret, drawn at
// the start: it ends with the overseer, and the token cannot be found out from it.
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

/// What somebody may do; each may do what those before it may.
enum class Standing : std::uint8_t {
  kStranger,  ///< have the page, and show a token
  kViewer,    ///< look at the world
  kOperator,  ///< change it
};

/// What of a request says who asks. Empty: not there.
struct Credentials {
  std::string_view authorization;
  std::string_view cookies;
};

/// With an HTTP status.
struct Refusal {
  unsigned status = 403;
  std::string why;
};

/// Used by one thread, but for wrong_tokens().
class WebAccess {
 public:
  using Clock = std::chrono::steady_clock;

  /// The port is the one that it listens on.
  explicit WebAccess(const WebSettings& settings);

  /// Why a request with these headers may not be served to whoever has connected to `local_address`; empty: it may.
  std::string why_not(std::string_view host, std::string_view origin, std::string_view local_address) const;

  /// After some wrong tokens of one address its next ones are not even looked at for a while; who has a cookie does not
  /// notice.
  std::variant<Standing, Refusal> standing_of(const std::string& address, const Credentials& credentials,
                                              Clock::time_point now);
  /// For Set-Cookie. Empty for strangers.
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
  std::string session_, view_session_;  ///< what the cookies hold
  std::map<std::string, core::TokenBucket> guesses_;
  std::atomic<std::uint64_t> wrong_tokens_ = 0;
};

}  // namespace aurasim::overseer
