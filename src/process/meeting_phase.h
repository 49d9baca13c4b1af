// The phases kListening, kMeeting and kWaiting of a node: finds out whether the domain is free, waits until all nodes
// of the run have found each other, and until the run starts. The decisions are in meeting.h.
#pragma once

#include <chrono>
#include <string_view>

#include "dds/round_trips.h"
#include "host/long_work.h"
#include "process/command_executor.h"
#include "process/exchange_choice.h"
#include "process/node_runtime.h"
#include "process/patience.h"

namespace aurasim::process {

class MeetingPhase {
 public:
  MeetingPhase(NodeRuntime& run, CommandExecutor& executor) : run_(run), executor_(executor) {}

  // Each of these functions returns false if the process was asked to stop, or has refused to run.
  /// Listens before anything is published: a node's endpoints would disturb a run that is already here.
  bool domain_is_free();
  /// Where the launch file says `exchange: auto`, chooses with the other nodes what it means in this run.
  bool agree_on_exchange();
  bool meet_neighbours();
  /// Waits for the command that starts the run. Region 0 sends it once every region waits for it.
  bool wait_for_start();

 private:
  bool finds_hub();
  bool another_run_is_here();
  bool measure_exchange();
  void measure(dds::RoundTrips& trips, RoundTripBook& book);
  bool receives_from_others();
  void note_meeting(Patience& patience, host::LongWork& waiting);
  void log_early_deaths();
  bool gives_up(std::string_view what, const Patience& patience, std::chrono::steady_clock::time_point began);

  NodeRuntime& run_;
  CommandExecutor& executor_;
  EarlyDeaths early_deaths_;
};

}  // namespace aurasim::process
