// The hub that a launcher starts for its run (dds.discovery: neighbours).
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

namespace aurasim::launch {

class HubProcess {
 public:
  ~HubProcess();

  /// Starts the program `words[0]` with these arguments.
  void start(std::vector<std::string> words);
  /// Starts it again if it has ended. The nodes wait for it then, and lose nothing.
  void look(std::chrono::steady_clock::time_point now);
  void stop();

 private:
  std::vector<std::string> words_;
  pid_t pid_ = 0;  ///< 0: none was started, or it has been stopped
  std::chrono::steady_clock::time_point started_;
};

}  // namespace aurasim::launch
