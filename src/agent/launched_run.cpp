#include "agent/launched_run.h"

#include <csignal>
#include <ctime>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/last_words.h"
#include "host/other_role.h"
#include "host/spawn.h"

namespace aurasim::agent {
namespace {

constexpr off_t kLongestLastWords_B = 3000;

void nap() {
  const ::timespec moment{0, 5'000'000};
  ::nanosleep(&moment, nullptr);
}

}  // namespace

LaunchedRun::LaunchedRun(const std::vector<std::string>& words) {
  std::vector<std::string> all = {host::own_program(), "launch"};
  all.insert(all.end(), words.begin(), words.end());
  pid_ = host::spawn(std::move(all));
}

LaunchedRun::~LaunchedRun() {
  if (is_running()) stop({});
}

bool LaunchedRun::is_running() {
  int status = 0;
  if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return pid_ > 0;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  pid_ = 0;
  return false;
}

void LaunchedRun::ask_to_stop() {
  if (is_running()) ::kill(pid_, SIGINT);
}

int LaunchedRun::stop(std::chrono::steady_clock::time_point deadline) {
  ask_to_stop();
  while (is_running()) {
    if (std::chrono::steady_clock::now() >= deadline) ::kill(pid_, SIGKILL);
    nap();
  }
  return exit_code_;
}

std::string last_words() {
  const int file = ::open("/proc/self/fd/2", O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::string words = client::last_words(file, kLongestLastWords_B);
  ::close(file);
  return words;
}

}  // namespace aurasim::agent
