// Signs of life of the processes that a launcher has started. They come over a pipe: DDS may be busy for many seconds
// with discovery alone, and then says of half of the nodes that their leases have run out.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace aurasim::cli {

/// Who hangs, by when its signs of life came. Time is passed in.
class LifeWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Call it often. Where the caller was held up itself, that time is nobody's silence.
  void look(Clock::time_point now);
  /// A sign of life has come.
  void note(pid_t process, Clock::time_point now);

  /// For how long a process that hangs has shown no life. Nothing: it lives, or has not shown any yet.
  std::optional<Clock::duration> silence_of(pid_t process, Clock::time_point now) const;
  /// So long a process may be silent. It grows with how far apart signs have come of late: a busy machine holds all up.
  Clock::duration patience() const;

 private:
  std::map<pid_t, Clock::time_point> heard_;
  std::optional<Clock::time_point> looked_;
  std::deque<std::pair<Clock::time_point, Clock::duration>> gaps_;  ///< long ones of late, and when they ended
};

/// The launcher's end.
class HeartbeatPipe {
 public:
  /// Throws std::runtime_error when there can be no pipe.
  HeartbeatPipe();
  ~HeartbeatPipe();
  HeartbeatPipe(const HeartbeatPipe&) = delete;
  HeartbeatPipe& operator=(const HeartbeatPipe&) = delete;

  /// What a process needs to be told to send its signs here.
  std::vector<std::string> words() const;
  /// Processes whose signs have come since the last call.
  std::vector<pid_t> take();

 private:
  int read_ = -1, write_ = -1;
};

/// The other end, named by number.
class Heartbeat {
 public:
  /// Below 0, or no pipe: beats into the void.
  explicit Heartbeat(int pipe);
  /// Does not wait. Any thread.
  void beat() const;

 private:
  int pipe_;
};

/// Keeps the pipe that a command line names open across exec. Does nothing where none is named.
void keep_heartbeat(const std::vector<std::string>& words);

}  // namespace aurasim::cli
