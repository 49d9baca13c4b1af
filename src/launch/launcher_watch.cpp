// Which nodes of a launcher hang, and which are slow.
#include <csignal>

#include <spdlog/spdlog.h>

#include "launch/launcher.h"

namespace aurasim::launch {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

/// Ends the processes of nodes that hang; their deaths are published then. The other nodes wait for a node that hangs,
/// and do not mark it dead by themselves.
void Launcher::end_hung_nodes() {
  const auto now = Clock::now();
  life_.look(now);
  for (const pid_t process : heartbeats_.take()) life_.note(process, now);
  const bool others_wait = children_.size() > 1;
  if (!others_wait || !has_begun_) return;
  for (Child& child : children_) {
    if (!child.running || child.hung == child.pid) continue;
    const messages::SeenStatus* const seen = said_by(child);  // null: it is about to become the node of its region
    if (seen == nullptr || seen->has_ended()) continue;
    const auto silence = life_.silence_of(child.pid, now);
    if (!silence) continue;
    child.hung = child.pid;
    spdlog::error("the node of region {} has shown no life for {:.1f} s: the launcher ends its process {}",
                  core::value_of(child.region), std::chrono::duration<double>(*silence).count(), child.pid);
    ::kill(child.pid, SIGKILL);
  }
}

void Launcher::tell_long_steps() {
  for (const auto& [region, seen] : control_.statuses()) {
    if (const auto news = long_steps_.news(seen, Clock::now())) spdlog::warn("{}", *news);
  }
}

}  // namespace aurasim::launch
