// Collects which participants Fast DDS refuses in a run with keys, and the reasons in words. Fast DDS gives the reason
// in its log, by numbers, and the refusal in callbacks without a reason. One instance for all participants of a
// process, as Fast DDS's log is.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>

#include "dds/refusal_limit.h"

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
  /// Returns the messages to report of a refusal: `message` with the participant's name, and `reason`; RefusalLimit
  /// says how many.
  std::vector<std::string> worth_saying(std::string message, const std::string& reason);

  mutable std::mutex mutex_;
  std::map<int, Tell> tells_;
  int next_number_ = 0;
  std::map<std::string, std::string> names_;  ///< by the text of the participant's prefix
  std::string reason_;                        ///< last logged reason, for the refusal that follows
  RefusalLimit limit_;
};

}  // namespace aurasim::dds
