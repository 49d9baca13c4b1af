// Shows how far a long piece of work is, and how long it may still take.
#pragma once

#include "lab/campaign.h"

namespace aurasim::lab::commands {

/// Writes to standard error. A terminal gets one line that is written over; files and pipes get one line for every
/// tenth.
class ProgressBar {
 public:
  ProgressBar();

  void show(const lab::Progress& progress);
  void end() const;

 private:
  bool is_terminal_;
  int last_tenth_ = -1;
};

}  // namespace aurasim::lab::commands
