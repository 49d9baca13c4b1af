// Reports work that takes more than a second, and how far it is.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <utility>

namespace aurasim::host {

class LongWork {
 public:
  using Clock = std::chrono::steady_clock;
  using Tell = std::function<void(const std::string&)>;

  /// `what`: a text such as "looking for bodies that overlap". `tell` receives a sentence after a second, and then at
  /// growing intervals (2, 4, 8 seconds), at least every 10 seconds.
  LongWork(std::string what, Tell tell, Clock::time_point now = Clock::now())
      : what_(std::move(what)), tell_(std::move(tell)), begin_(now) {}

  /// To be called often. `share` of the work is done, 0 to 1.
  void reached(double share, Clock::time_point now = Clock::now());

 private:
  std::string what_;
  Tell tell_;
  Clock::time_point begin_;
  Clock::duration next_ = std::chrono::seconds(1);  ///< from the begin
};

}  // namespace aurasim::host
