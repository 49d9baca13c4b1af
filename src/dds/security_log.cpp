#include "dds/security_log.h"

#include <memory>
#include <sstream>
#include <string_view>
#include <utility>

#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/log/StdoutErrConsumer.hpp>
#include <fmt/format.h>

namespace aurasim::dds {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;
using eprosima::fastdds::dds::StdoutErrConsumer;
using eprosima::fastrtps::rtps::GUID_t;
using eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;

namespace {

constexpr const char* kOurs = "SECURITY_AURASIM";
constexpr const char* kReasons = "SECURITY_AUTHENTICATION";
constexpr const char* kRefused = "refused ";

// Limits on what unknown processes can make this process remember.
constexpr std::size_t kMostNames = 4096;
constexpr std::size_t kLongestClaim = 128;

/// Length of a participant's number in text, which is written 01.0f.(...).c1|0.0.1.c1: twelve octets of the
/// participant, then the entity.
constexpr std::size_t kPrefix = 12 * 3 - 1;

/// True for log entries about security that are useful. Warnings other than kReasons are not: there are dozens a second
/// while two participants are matched.
bool is_about_security(const std::string& category, const std::string& message) {
  return category.starts_with("SECURITY") || (category == "RTPS_EDP" && message.starts_with("Security manager"));
}

/// Consumer of Fast DDS's log: passes on all entries except those about security.
class Listener final : public LogConsumer {
 public:
  void Consume(const Log::Entry& entry) override {
    const std::string category = entry.context.category == nullptr ? "" : entry.context.category;
    const bool is_error = entry.kind == Log::Kind::Error;
    if (category == kOurs || category == kReasons || (is_error && is_about_security(category, entry.message))) {
      SecurityLog::instance().receive(entry.message, category);
    } else if (is_error) {
      others_.Consume(entry);
    }
  }

 private:
  StdoutErrConsumer others_;
};

template <class T>
std::string text_of(const T& value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Replaces unprintable characters: the text comes from an unknown process and goes to a terminal.
std::string printable(const std::string& text) {
  std::string out;
  for (const char c : text.substr(0, kLongestClaim)) out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

std::string claim_in(const ParticipantDiscoveryInfo& info) {
  for (const auto& property : info.info.identity_token_.properties()) {
    if (property.name() == "dds.cert.sn") return "which claims to be " + printable(property.value());
  }
  return "without keys";
}

std::string address_in(const ParticipantDiscoveryInfo& info) {
  const auto& locators = info.info.metatraffic_locators.unicast;
  return locators.empty() ? "nowhere" : text_of(locators.at(0));
}

/// Removes the place in Fast DDS's sources from a log message.
std::string without_place(std::string message) {
  for (std::size_t place = 0; (place = message.find(" (./src")) != std::string::npos;) {
    const std::size_t end = message.find(')', place);
    message.erase(place, end == std::string::npos ? end : end + 1 - place);
  }
  while (!message.empty() && (message.back() == '\n' || message.back() == '.')) message.pop_back();
  return message;
}

}  // namespace

SecurityLog& SecurityLog::instance() {
  static SecurityLog* log = new SecurityLog;  // Fast DDS's log thread outlives what is destroyed at the end
  return *log;
}

SecurityLog::SecurityLog() {
  Log::ClearConsumers();
  Log::RegisterConsumer(std::make_unique<Listener>());
  Log::SetVerbosity(Log::Kind::Warning);
}

SecurityLog::Hearing::Hearing(Tell tell) {
  SecurityLog& log = instance();
  const std::lock_guard lock(log.mutex_);
  number_ = log.next_number_++;
  log.tells_.emplace(number_, std::move(tell));
}

SecurityLog::Hearing::~Hearing() {
  SecurityLog& log = instance();
  {
    const std::lock_guard lock(log.mutex_);
    log.tells_.erase(number_);
  }
  Log::Flush();  // waits until calls under way have returned
}

void SecurityLog::note(const ParticipantDiscoveryInfo& info) {
  const std::string prefix = text_of(info.info.m_guid.guidPrefix);
  const std::lock_guard lock(mutex_);
  if (info.status == ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    names_.erase(prefix);
  } else if (names_.size() < kMostNames) {
    names_.insert_or_assign(prefix, fmt::format("the participant at {}, {}", address_in(info), claim_in(info)));
  }
}

void SecurityLog::refused(const GUID_t& participant) {
  // Goes through the log, so that it is handled after the reason.
  Log::QueueLog(kRefused + text_of(participant), Log::Context{__FILE__, __LINE__, __func__, kOurs}, Log::Kind::Warning);
}

void SecurityLog::receive(const std::string& message, const std::string& category) {
  std::vector<std::string> texts;
  std::map<int, Tell> tells;
  {
    const std::lock_guard lock(mutex_);
    if (category == kOurs) {
      const std::string reason = std::exchange(reason_, {});
      texts = worth_saying(message, reason.empty() ? "" : ": " + reason);
    } else if (category == kReasons) {
      reason_ = without_place(message);
    } else {
      texts = worth_saying(without_place(message), "");
    }
    tells = tells_;
  }
  for (const std::string& text : texts) {  // unlocked: a blocked terminal must not hold up DDS's threads
    for (const auto& [number, tell] : tells) {
      if (tell) tell(text);
    }
  }
}

std::vector<std::string> SecurityLog::worth_saying(std::string message, const std::string& reason) {
  const std::size_t bar = message.find('|');
  if (bar == std::string::npos || bar < kPrefix) return limit_.worth_saying("", message + reason, Clock::now());
  const std::string prefix = message.substr(bar - kPrefix, kPrefix);
  const auto name = names_.find(prefix);
  if (name != names_.end()) message.insert(bar - kPrefix, fmt::format("[{}] ", name->second));
  return limit_.worth_saying(prefix, message + reason, Clock::now());
}

std::string SecurityLog::with_name_of_process(std::string text) const {
  constexpr std::string_view kBefore = "process ";
  if (!text.starts_with(kBefore) || text.size() < kBefore.size() + kPrefix) return text;
  const std::lock_guard lock(mutex_);
  const auto name = names_.find(text.substr(kBefore.size(), kPrefix));
  if (name != names_.end()) text.insert(kBefore.size() + kPrefix, fmt::format(" [{}]", name->second));
  return text;
}

}  // namespace aurasim::dds
