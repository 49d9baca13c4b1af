// Whom Fast DDS refuses in a run with keys, and why, in words: it says so in its log, by numbers, and in callbacks that
// have no reason. One for all participants of a process, as its log is.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>

namespace aurasim::dds {

/// Thread-safe.
class SecurityLog {
 public:
  using Tell = std::function<void(const std::string&)>;

  /// From the first call on, Fast DDS's log about security comes here, and the rest of it goes where it went.
  static SecurityLog& instance();

  /// Tells somebody as long as it lives; from DDS's threads.
  class Hearing {
   public:
    explicit Hearing(Tell tell);
    ~Hearing();
    Hearing(const Hearing&) = delete;
    Hearing& operator=(const Hearing&) = delete;

   private:
    int number_ = 0;
  };

  /// Who a participant says it is: nothing is proved yet.
  void note(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// "process 01.0f...": the name of that one is put behind its number.
  std::string with_name_of_process(std::string text) const;
  /// It could not prove it. Fast DDS has logged the reason just before.
  void refused(const eprosima::fastrtps::rtps::GUID_t& participant);
  /// An entry of Fast DDS's log about security.
  void hear(const std::string& message, const std::string& category);

 private:
  using Clock = std::chrono::steady_clock;

  SecurityLog();
  /// `text`, unless it has just been said, or there is too much to say.
  std::vector<std::string> worth_saying(const std::string& text);
  std::string with_names(std::string message) const;

  mutable std::mutex mutex_;
  std::map<int, Tell> tells_;
  int next_number_ = 0;
  std::map<std::string, std::string> names_;  ///< by the text of the participant's prefix
  std::string reason_;                        ///< heard last, of somebody who is about to be refused
  std::map<std::string, Clock::time_point> said_;
  Clock::time_point window_begin_{};
  std::uint64_t in_window_ = 0;
  std::uint64_t unsaid_ = 0;
};

}  // namespace aurasim::dds
