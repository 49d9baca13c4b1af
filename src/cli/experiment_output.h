// What an experiment shows while it runs and when it has ended.
#pragma once

#include <vector>

#include "experiment/campaign.h"
#include "experiment/summary.h"

namespace aurasim::cli {

/// A line that is written over on a terminal; elsewhere one line for every tenth.
class ProgressBar {
 public:
  ProgressBar();
  void show(const experiment::Progress& progress);
  void end() const;

 private:
  bool is_terminal_;
  int last_tenth_ = -1;
};

void print(const std::vector<experiment::Target>& targets);
bool all_met(const std::vector<experiment::Target>& targets);

}  // namespace aurasim::cli
