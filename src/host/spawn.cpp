#include "host/spawn.h"

#include <csignal>
#include <fstream>
#include <stdexcept>

#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host/heartbeat.h"

namespace aurasim::host {
namespace {

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// In a child, before it becomes the program. A signal that our handler took here would be lost for that.
void hear_signals_as_usual() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) std::signal(signal, SIG_DFL);
  }
}

}  // namespace

std::vector<std::string> own_command_line() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

void become(std::vector<std::string> words) {
  ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  keep_heartbeat(words);
  ::execv(words.at(0).c_str(), pointers_to(words).data());
  throw std::runtime_error("cannot start " + words[0]);
}

pid_t spawn(std::vector<std::string> words, int output) {
  const std::vector<char*> arguments = pointers_to(words);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error("cannot start a process");
  if (pid == 0) {
    ::setpgid(0, 0);
    hear_signals_as_usual();
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(0);  // it died before that
    if (output != STDOUT_FILENO) ::dup2(output, STDOUT_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  return pid;
}

void spawn_apart(std::vector<std::string> words) {
  const std::vector<char*> arguments = pointers_to(words);
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error("cannot start a process");
  if (pid == 0) {
    // Its own child is nobody's: we need not wait for its end.
    if (::fork() != 0) ::_exit(0);
    ::setsid();
    hear_signals_as_usual();
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::waitpid(pid, nullptr, 0);
}

}  // namespace aurasim::host
