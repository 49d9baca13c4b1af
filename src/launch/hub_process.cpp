#include "launch/hub_process.h"

#include <csignal>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include "dds/hub.h"
#include "host/spawn.h"

namespace aurasim::launch {
namespace {

/// Time between two looks for a hub of others, and between two starts of one that cannot run.
constexpr std::chrono::seconds kBetweenLooks{1};

}  // namespace

HubProcess::~HubProcess() { stop(); }

void HubProcess::keep(std::vector<std::string> words, const dds::Settings& settings) {
  if (settings.discovery != config::Discovery::kNeighbours) return;
  words_ = std::move(words);
  settings_ = settings;
  look(std::chrono::steady_clock::now());
}

void HubProcess::look(std::chrono::steady_clock::time_point now) {
  if (words_.empty()) return;
  if (pid_ != 0 && ::waitpid(pid_, nullptr, WNOHANG) == pid_) {
    pid_ = 0;
    spdlog::warn("the hub of the run has ended; the launcher starts it again");
  }
  if (pid_ != 0 || now < next_look_) return;
  next_look_ = now + kBetweenLooks;
  if (!dds::Hub::is_there(settings_)) pid_ = host::spawn(words_);
}

void HubProcess::stop() {
  words_.clear();
  if (pid_ == 0) return;
  ::kill(pid_, SIGKILL);  // it has nothing to finish
  ::waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

}  // namespace aurasim::launch
