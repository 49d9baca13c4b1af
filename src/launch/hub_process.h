// The hub that a launcher runs for its run (dds.discovery: neighbours).
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

#include "dds/settings.h"

namespace aurasim::launch {

class HubProcess {
 public:
  ~HubProcess();

  /// If discovery needs one, the DDS domain of `settings` has a hub from now on: one that is there already, or the
  /// program `words[0]` with these arguments.
  void keep(std::vector<std::string> words, const dds::Settings& settings);
  /// Starts the program if the domain has no hub any more. Nodes wait for it then, and lose nothing.
  void look(std::chrono::steady_clock::time_point now);
  void stop();

 private:
  std::vector<std::string> words_;  ///< empty: no hub is needed
  dds::Settings settings_;
  pid_t pid_ = 0;  ///< 0: none of ours is running
  std::chrono::steady_clock::time_point next_look_;
};

}  // namespace aurasim::launch
