// The overseer that a launch starts. It is a process of its own, so that its failure does not affect the run.
#pragma once

#include <string>

#include <sys/types.h>

#include "setup/arguments.h"

namespace aurasim::launch {

class ViewerProcess {
 public:
  ViewerProcess() = default;
  /// Ends the process.
  ~ViewerProcess();
  ViewerProcess(const ViewerProcess&) = delete;
  ViewerProcess& operator=(const ViewerProcess&) = delete;

  /// Starts the process. `recording`: file to record into; empty: none.
  void start(const command_line::FileArguments& files, const std::string& recording);
  /// Reads the process's output, and notices when it has ended. Never blocks.
  void look();
  /// The overseer's address, and its token if it has one. Empty before it listens.
  const std::string& said() const { return said_; }
  /// True if the process has ended by itself, before stop().
  bool has_ended_early() const { return ended_early_; }
  void stop();

 private:
  pid_t pid_ = 0;
  int output_ = -1;
  bool ended_early_ = false;
  std::string said_;
};

}  // namespace aurasim::launch
