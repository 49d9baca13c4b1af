// The overseer that comes with a launch: a process of its own, so that nothing that happens to it matters to the run.
#pragma once

#include <string>

#include <sys/types.h>

#include "cli/commands.h"

namespace aurasim::cli {

class ViewerProcess {
 public:
  ViewerProcess() = default;
  /// Ends it.
  ~ViewerProcess();
  ViewerProcess(const ViewerProcess&) = delete;
  ViewerProcess& operator=(const ViewerProcess&) = delete;

  /// `recording`: file; empty: none.
  void start(const FileArguments& files, const std::string& recording);
  /// Reads what it has printed; notices when it has ended. Never waits.
  void look();
  /// Its address, and its token if it has one; empty before it listens.
  const std::string& said() const { return said_; }
  /// By itself, before it was stopped.
  bool has_ended_early() const { return ended_early_; }
  void stop();

 private:
  pid_t pid_ = 0;
  int output_ = -1;
  bool ended_early_ = false;
  std::string said_;
};

}  // namespace aurasim::cli
