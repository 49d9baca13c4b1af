#include "overseer/web_access.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "overseer/http_rules.h"

namespace aurasim::overseer {
namespace {

constexpr double kGuesses = 10;         // wrong tokens that one address may send at once
constexpr double kGuesses_per_s = 0.2;  // wrong tokens a second that it may send from then on
constexpr std::size_t kMostGuessers = 1'000;

}  // namespace

WebAccess::WebAccess(const WebSettings& settings)
    : has_tls_(settings.tls.has_value()),
      names_(settings.names),
      token_(settings.token),
      view_token_(settings.view_token),
      // Browsers send a host's cookies to all its ports. Only over TLS can a name (__Host-) be protected from servers
      // without TLS.
      cookie_name_(fmt::format("{}aurasim_{}", has_tls_ ? "__Host-" : "", settings.port)),
      session_(make_token()),
      view_session_(make_token()) {}

std::string WebAccess::why_not(std::string_view host, std::string_view origin, std::string_view local_address) const {
  if (!is_meant(host, local_address))
    return "this server is not asked for by that name: use its address, or start it with --name";
  if (!origin.empty() && !is_same_origin(origin, host, has_tls_)) return "pages of other sites may not ask this server";
  return {};
}

bool WebAccess::is_meant(std::string_view host, std::string_view local_address) const {
  if (is_loopback_name(host)) return true;  // no foreign page can have this Host
  const std::string name = lower(host_name(host));
  if (name == local_address || name == fmt::format("[{}]", local_address)) return true;
  return std::any_of(names_.begin(), names_.end(), [&](const std::string& known) { return matches_name(name, known); });
}

std::variant<Standing, Refusal> WebAccess::standing_of(const std::string& address, const Credentials& credentials,
                                                       Clock::time_point now) {
  if (!credentials.authorization.empty()) {
    core::TokenBucket& guesses = guesses_of(address, now);
    if (guesses.is_spent(now.time_since_epoch())) return Refusal{429, "too many wrong tokens: try again in a minute"};
    const std::string_view token = bearer_token(credentials.authorization);
    const bool is_operators = !token_.empty() && equal_in_constant_time(token, token_);
    const bool is_viewers = !view_token_.empty() && equal_in_constant_time(token, view_token_);
    if (is_operators) return Standing::kOperator;
    if (is_viewers) return Standing::kViewer;
    if (!is_open()) {
      ++wrong_tokens_;
      guesses.charge(now.time_since_epoch());
      if (guesses.is_spent(now.time_since_epoch()))
        spdlog::warn("the viewer has got {} wrong tokens from {}", kGuesses, address);
      return Refusal{401, "the token is missing or wrong"};
    }
  }
  if (is_open()) return Standing::kOperator;
  const std::string_view session = cookie_value(credentials.cookies, cookie_name_);
  if (equal_in_constant_time(session, session_)) return Standing::kOperator;
  if (view_token_.empty() || equal_in_constant_time(session, view_session_)) return Standing::kViewer;
  return Standing::kStranger;
}

std::string WebAccess::cookie(Standing standing) const {
  if (standing == Standing::kStranger) return {};
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", cookie_name_,
                     standing == Standing::kOperator ? session_ : view_session_, has_tls_ ? "; Secure" : "");
}

/// Returns the bucket of wrong tokens of an address. Addresses without a recent guess are forgotten, and if there are
/// still too many, any other one.
core::TokenBucket& WebAccess::guesses_of(const std::string& address, Clock::time_point now) {
  if (guesses_.size() >= kMostGuessers && !guesses_.contains(address)) {
    std::erase_if(guesses_, [now](const auto& entry) { return entry.second.is_full(now.time_since_epoch()); });
    if (guesses_.size() >= kMostGuessers) guesses_.erase(guesses_.begin());
  }
  return guesses_.try_emplace(address, kGuesses_per_s, kGuesses).first->second;
}

}  // namespace aurasim::overseer
