// One node as a process: joins the DDS domain, waits for its neighbours, computes states at their time, executes run
// commands, records, and recovers with the others when a node dies. This is the loop; docs/architecture.md, "A
// process", shows what it calls.
#pragma once

#include "command_line/exit_code.h"
#include "process/changing_phase.h"
#include "process/client_service.h"
#include "process/command_executor.h"
#include "process/ending_phase.h"
#include "process/meeting_phase.h"
#include "process/node_runtime.h"
#include "process/recovering_phase.h"
#include "process/succession.h"

namespace aurasim::process {

class NodeProcess {
 public:
  NodeProcess(config::Launch launch, const NodeOptions& options);

  command_line::ExitCode run();
  /// To be called after run(). True if another process has this region now, so that this process may serve the run as a
  /// spare.
  bool comes_back_as_spare() const;

 private:
  command_line::ExitCode meet_and_run();
  command_line::ExitCode take_over();
  command_line::ExitCode not_begun();
  command_line::ExitCode run_steps();
  void look_for_death_at_the_end();
  void run_until_end();
  bool is_over();
  bool finished();
  bool wait_until_due();
  void wait_in_pause();
  void compute_step();
  void keep_the_end();
  void note_redo(const node::StepReport& report);
  void take_setpoints();
  bool has_awaited_setpoints();
  void note_waiting();

  NodeRuntime run_;
  Succession succession_;
  CommandExecutor executor_;
  ClientService clients_;
  MeetingPhase meeting_;
  ChangingPhase changing_;
  RecoveringPhase recovering_;
  EndingPhase ending_;
};

}  // namespace aurasim::process
