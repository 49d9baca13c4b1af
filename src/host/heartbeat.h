// Signs of life of the processes that a launcher has started. They come over a pipe, because DDS may be busy with
// discovery for many seconds and then report that the leases of half of the nodes have run out.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace aurasim::host {

/// Finds processes that hang, from the times of their signs of life. Time is passed in.
class LifeWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// To be called often. If the caller itself was held up, that time does not count as silence of the processes.
  void look(Clock::time_point now);
  /// Notes a sign of life of `process`.
  void note(pid_t process, Clock::time_point now);

  /// How long a process that hangs has been silent. Nothing if it lives, or has not sent any sign yet.
  std::optional<Clock::duration> silence_of(pid_t process, Clock::time_point now) const;
  /// How long a process may be silent. The time grows with the recent gaps between signs, because a busy machine delays
  /// all processes.
  Clock::duration patience() const;

 private:
  std::map<pid_t, Clock::time_point> heard_;
  std::optional<Clock::time_point> looked_;
  std::deque<std::pair<Clock::time_point, Clock::duration>> gaps_;  ///< recent long gaps, with the time when each ended
};

/// The launcher's end of the pipe.
class HeartbeatPipe {
 public:
  /// Throws std::runtime_error when the pipe cannot be made.
  HeartbeatPipe();
  ~HeartbeatPipe();
  HeartbeatPipe(const HeartbeatPipe&) = delete;
  HeartbeatPipe& operator=(const HeartbeatPipe&) = delete;

  /// Command-line words that make a process send its signs of life to this pipe.
  std::vector<std::string> words() const;
  /// Processes whose signs have come since the last call.
  std::vector<pid_t> take();

 private:
  int read_ = -1, write_ = -1;
};

/// The node's end of the pipe, given by its file descriptor.
class Heartbeat {
 public:
  /// `pipe`: file descriptor. If it is below 0 or no pipe, beat() does nothing.
  explicit Heartbeat(int pipe);
  /// Sends a sign of life. Does not block. May be called from any thread.
  void beat() const;

 private:
  int pipe_;
};

/// Keeps the pipe that a command line names open across exec. Does nothing where none is named.
void keep_heartbeat(const std::vector<std::string>& words);

}  // namespace aurasim::host
