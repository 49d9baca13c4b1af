// Starts the agent's process (agent/), asks it, and ends it.
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

  /// Starts `program`. `log`: file for its output; empty: the output is kept for the text of errors. `interrupted`:
  /// asked while a call waits; true ends it. Throws NoProgram.
  Connection(const std::string& program, const std::string& log, std::function<bool()> interrupted);
  /// Ends the agent if it has not ended.
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Asks the agent and returns its answer. Throws the error that the agent reports (errors.h), Interrupted, or Ended
  /// when the agent is gone or does not answer long after the time-out.
  Message ask(Message question, Seconds time_out);
  /// Takes note that the agent has launched a run by the process `launcher`. close() then waits for its end, also when
  /// the agent dies.
  void watch_launcher(pid_t launcher);
  /// Asks the agent to end, and waits for it; after the time-out kills it and the launcher. Returns the launcher's exit
  /// code, or that of an agent that died before its run (128 + a signal); 0 if there was neither.
  int close(Seconds time_out);
  bool is_open() const { return socket_ >= 0; }
  pid_t pid() const { return pid_; }

 private:
  void start(const std::string& program, int socket);
  Message read_answer(std::uint64_t request, std::chrono::steady_clock::time_point deadline);
  void end(std::chrono::steady_clock::time_point deadline);
  int end_launcher(std::chrono::steady_clock::time_point deadline);

  std::function<bool()> interrupted_;
  pid_t owner_;  ///< process that created this. A forked child has a copy, and must leave the agent alone.
  int socket_ = -1;
  int log_ = -1;
  pid_t pid_ = 0;
  int exit_code_ = 0;  ///< exit code of the agent; 128 + a signal that has ended it
  int launcher_ = -1;  ///< pidfd of the launcher; -1: none was launched, or its end was seen
  std::uint64_t requests_ = 0;
};

}  // namespace aurasim::client
