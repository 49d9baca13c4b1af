#include "cli/agent/launched_run.h"

#include <algorithm>
#include <csignal>
#include <ctime>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/launch_setup.h"
#include "cli/spawn.h"

namespace aurasim::cli::agent {
namespace {

constexpr off_t kLongestLastWords_B = 3000;

void nap() {
  const ::timespec moment{0, 5'000'000};
  ::nanosleep(&moment, nullptr);
}

}  // namespace

LaunchedRun::LaunchedRun(const std::vector<std::string>& words) {
  std::vector<std::string> all = {executable_for("double").string(), "launch"};
  all.insert(all.end(), words.begin(), words.end());
  pid_ = spawn(std::move(all));
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
  struct ::stat about {};
  std::string words;
  if (file >= 0 && ::fstat(file, &about) == 0 && S_ISREG(about.st_mode)) {
    words.resize(static_cast<std::size_t>(std::min<off_t>(about.st_size, kLongestLastWords_B)));
    const ssize_t got = ::pread(file, words.data(), words.size(), about.st_size - static_cast<off_t>(words.size()));
    words.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  }
  if (file >= 0) ::close(file);
  while (!words.empty() && words.back() == '\n') words.pop_back();
  return words;
}

}  // namespace aurasim::cli::agent
