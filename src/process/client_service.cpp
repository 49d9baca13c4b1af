#include "process/client_service.h"

#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "core/wall_clock.h"
#include "process/run_view.h"
#include "process/step_back.h"

namespace aurasim::process {
namespace {

constexpr std::chrono::nanoseconds kNoticeOfStepBack{600'000'000};  // time in which all nodes receive the command

}  // namespace

void ClientService::serve_clients() {
  if (run_.changes.is_about_to_change(run_.node->current_step())) return;
  const RunView view = view_of_run(run_.control().statuses(), run_.status.content(), run_.schedule.holds_at());
  run_.endpoints.commands().serve(*run_.node, view);
  run_.saving.save_as_it_stands(*run_.node, run_.endpoints.commands());
  if (view.leads) {
    run_.saving.save_regularly(*run_.node, run_.first_step());
    compute_until_change();
    step_back(view);
  }
  run_.status.content().meshes = run_.endpoints.commands().meshes();
  // A run command and no order, because steps may be seconds apart.
  if (const std::optional<double> rate = run_.endpoints.commands().take_wanted_rate()) {
    executor_.command_all(run_.schedule.rate_command(*rate, run_.node->current_step(), core::wall_clock_ns()));
  }
}

/// Makes a paused run compute up to a change. All nodes pause again in the first state of the new world.
void ClientService::compute_until_change() {
  const std::optional<core::Step> change = run_.endpoints.commands().change_at();
  if (!change) return;
  auto steps =
      run_.schedule.steps_to(*change, run_.node->current_step(), run_.node->confirmed_step(), core::wall_clock_ns());
  if (!steps) return;
  steps->run = run_.options.run;
  executor_.command_all(*steps);
}

/// Handles the request "step back". All nodes go back to the newest state that all have in memory, or that the lead
/// finds in its folder. It lies at least half the distance of two kept states back.
void ClientService::step_back(const RunView& view) {
  const std::optional<core::Command> back = run_.endpoints.commands().take_wanted_back();
  if (!back) return;
  const core::Step latest = run_.node->current_step() - (run_.launch.checkpoint_steps() + 1) / 2;
  run_.status.content().parts = run_.checkpoints().parts();
  const std::optional<messages::RunCommand> restore =
      run_.recovers() ? plan_step_back(run_.nodes_and_self(), run_.launch.regions.size(), latest) : std::nullopt;
  const cut::SavedState saved = cut::newest_saved_until(run_.options.saves, run_.saving.saved_by(), latest);
  if (restore && restore->at_step >= saved.step) return send_back(*restore, *back);
  if (saved.step >= 0) return run_.endpoints.commands().load_instead(*back, saved.name, *run_.node, view);
  run_.endpoints.commands().refuse(
      back->request, fmt::format("the run keeps no state up to state {}, so it cannot step back", latest));
}

/// Sends a restore as after a death. No node has died, so the new generation begins at once, and is paused if this one
/// was.
void ClientService::send_back(messages::RunCommand restore, const core::Command& back) {
  restore.epoch_ns = core::wall_clock_ns() + kNoticeOfStepBack.count();
  run_.schedule.hold_earlier_in(restore.at_step);
  run_.endpoints.commands().go_back_to(back, restore.at_step);
  run_.send_restore(restore);
}

}  // namespace aurasim::process
