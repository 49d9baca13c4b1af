#include "dds/refusal_limit.h"

#include <utility>

#include <fmt/format.h>

namespace aurasim::dds {

std::vector<std::string> RefusalLimit::worth_saying(const std::string& who, const std::string& text, Time now) {
  if (const auto said = said_.find(text); said != said_.end() && now < said->second + kSayAgain) return {};
  if (now > window_begin_ + kWindow) {
    window_begin_ = now;
    of_one_.clear();
    of_all_ = 0;
  }
  if (of_all_ >= kMostOfAll || of_one_[who] >= kMostOfOne) {
    ++unsaid_;
    return {};
  }
  ++of_all_;
  ++of_one_[who];
  if (said_.size() >= kMostRemembered) said_.clear();
  said_[text] = now;
  const std::uint64_t unsaid = std::exchange(unsaid_, 0);
  if (unsaid == 0) return {text};
  return {fmt::format("{} more refusals were not listed", unsaid), text};
}

}  // namespace aurasim::dds
