#include "launch/hub_process.h"

#include <csignal>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include "host/spawn.h"

namespace aurasim::launch {
namespace {

/// Time between two starts, so that one that cannot run is not started all the time.
constexpr std::chrono::seconds kBetweenStarts{1};

}  // namespace

HubProcess::~HubProcess() { stop(); }

void HubProcess::start(std::vector<std::string> words) {
  words_ = std::move(words);
  pid_ = host::spawn(words_);
  started_ = std::chrono::steady_clock::now();
}

void HubProcess::look(std::chrono::steady_clock::time_point now) {
  if (words_.empty()) return;
  if (pid_ != 0 && ::waitpid(pid_, nullptr, WNOHANG) == pid_) {
    pid_ = 0;
    spdlog::warn("the hub of the run has ended; the launcher starts it again");
  }
  if (pid_ != 0 || now < started_ + kBetweenStarts) return;
  pid_ = host::spawn(words_);
  started_ = now;
}

void HubProcess::stop() {
  words_.clear();
  if (pid_ == 0) return;
  ::kill(pid_, SIGKILL);  // it has nothing to finish
  ::waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

}  // namespace aurasim::launch
