#include "cli/viewer_process.h"

#include <array>
#include <csignal>
#include <ctime>
#include <vector>

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/launch_setup.h"

namespace aurasim::cli {

ViewerProcess::~ViewerProcess() { stop(); }

void ViewerProcess::start(const FileArguments& files, const std::string& recording) {
  std::vector<std::string> words = {executable_for("double").string(), "overseer", files.file};
  for (const std::string& change : files.overrides) words.insert(words.end(), {"--set", change});
  if (!recording.empty()) words.insert(words.end(), {"--record", recording});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return spdlog::warn("no viewer: cannot open a pipe");
  pid_ = ::fork();
  if (pid_ == 0) {
    ::setpgid(0, 0);                     // Ctrl-C is the launcher's to handle
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // and nobody outlives it
    ::dup2(pipe[1], STDOUT_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ::close(pipe[1]);
  output_ = pipe[0];
  ::fcntl(output_, F_SETFL, O_NONBLOCK);
  if (pid_ < 0) {
    pid_ = 0;
    spdlog::warn("no viewer: cannot start a process");
  }
}

void ViewerProcess::look() {
  if (pid_ == 0) return;
  std::array<char, 512> text{};
  for (ssize_t n = 0; (n = ::read(output_, text.data(), text.size())) > 0;) said_.append(text.data(), n);
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return;
  pid_ = 0;
  said_.clear();
  spdlog::warn("the viewer has ended; the run goes on. `aurasim overseer` starts another");
}

void ViewerProcess::stop() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    for (int i = 0; i < 200; ++i) {
      if (::waitpid(pid_, nullptr, WNOHANG) == pid_) {
        pid_ = 0;
        break;
      }
      const ::timespec nap{0, 5'000'000};
      ::nanosleep(&nap, nullptr);
    }
  }
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (output_ >= 0) ::close(output_);
}

}  // namespace aurasim::cli
