// The agent's process (cli/agent/): started, asked, and ended.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include <sys/types.h>

#include "client/message.h"

namespace aurasim::client {

class Connection {
 public:
  using Seconds = std::chrono::duration<double>;

  /// Starts `program`. `log`: file for its words; empty: they are kept for the text of errors. Throws NoProgram.
  Connection(const std::string& program, const std::string& log, std::function<bool()> interrupted);
  /// Ends it, if it has not ended.
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Its answer; throws what it says (errors.h), Interrupted, or Ended when it has gone or is silent long after the
  /// time-out.
  Message ask(Message question, Seconds time_out);
  /// The agent has launched a run, by this process: close() waits for its end, also when the agent dies.
  void watch_launcher(pid_t launcher);
  /// Asks it to end, and waits for that; after the time-out it is killed, and so is the launcher. Returns the
  /// launcher's exit code, or that of an agent that died before its run (128 + a signal); 0: there is none.
  int close(Seconds time_out);
  bool is_open() const { return socket_ >= 0; }
  pid_t pid() const { return pid_; }

 private:
  void start(const std::string& program, int socket);
  Message read_answer(std::uint64_t request, std::chrono::steady_clock::time_point deadline);
  void end(std::chrono::steady_clock::time_point deadline);
  int end_launcher(std::chrono::steady_clock::time_point deadline);

  std::function<bool()> interrupted_;
  pid_t owner_;  ///< a child of ours has a copy of this, and must leave the agent alone
  int socket_ = -1;
  int log_ = -1;
  pid_t pid_ = 0;
  int exit_code_ = 0;  ///< of the agent; 128 + a signal that has ended it
  int launcher_ = -1;  ///< a descriptor of its process; -1: none was launched, or its end was seen
  std::uint64_t requests_ = 0;
};

}  // namespace aurasim::client
