// Collects which participants Fast DDS refuses in a run with keys, and the reasons in words. Fast DDS gives the reason
// in its log, by numbers, and the refusal in callbacks without a reason. One instance for all participants of a
// process, as Fast DDS's log is.
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

  /// Returns the instance. From the first call on Fast DDS's log entries about security come here; all others go where
  /// they went before.
  static SecurityLog& instance();

  /// Subscription: calls its function for each refusal, from DDS's threads, as long as it lives.
  class Hearing {
   public:
    explicit Hearing(Tell tell);
    ~Hearing();
    Hearing(const Hearing&) = delete;
    Hearing& operator=(const Hearing&) = delete;

   private:
    int number_ = 0;
  };

  /// Takes note of the name that a participant claims, which is not proved yet.
  void note(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// Adds the process's name behind each process number ("process 01.0f...") in `text`.
  std::string with_name_of_process(std::string text) const;
  /// Handles that `participant` failed to prove its identity. Fast DDS has logged the reason just before.
  void refused(const eprosima::fastrtps::rtps::GUID_t& participant);
  /// Handles an entry of Fast DDS's log about security.
  void receive(const std::string& message, const std::string& category);

 private:
  using Clock = std::chrono::steady_clock;

  SecurityLog();
  /// Returns the messages to report: `text`, preceded by the number of messages left out so far if there were any.
  /// Empty if `text` was just reported or there is too much to report.
  std::vector<std::string> worth_saying(const std::string& text);
  std::string with_names(std::string message) const;

  mutable std::mutex mutex_;
  std::map<int, Tell> tells_;
  int next_number_ = 0;
  std::map<std::string, std::string> names_;  ///< by the text of the participant's prefix
  std::string reason_;                        ///< last logged reason, for the refusal that follows
  std::map<std::string, Clock::time_point> said_;
  Clock::time_point window_begin_{};
  std::uint64_t in_window_ = 0;
  std::uint64_t unsaid_ = 0;
};

}  // namespace aurasim::dds
