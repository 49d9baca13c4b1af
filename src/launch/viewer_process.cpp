#include "launch/viewer_process.h"

#include <array>
#include <csignal>
#include <ctime>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host/other_role.h"
#include "host/spawn.h"

namespace aurasim::launch {

ViewerProcess::~ViewerProcess() { stop(); }

void ViewerProcess::start(const command_line::FileArguments& files, const std::string& recording) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return spdlog::warn("no viewer: cannot open a pipe");
  try {
    std::vector<std::string> words = {host::own_program(), "overseer", files.file};
    for (const std::string& change : files.overrides) words.insert(words.end(), {"--set", change});
    if (!recording.empty()) words.insert(words.end(), {"--record", recording});
    pid_ = host::spawn(std::move(words), pipe[1]);
  } catch (const std::runtime_error& error) {
    spdlog::warn("no viewer: {}", error.what());
  }
  ::close(pipe[1]);
  output_ = pipe[0];
  ::fcntl(output_, F_SETFL, O_NONBLOCK);
}

void ViewerProcess::look() {
  if (pid_ == 0) return;
  std::array<char, 512> text{};
  for (ssize_t n = 0; (n = ::read(output_, text.data(), text.size())) > 0;) said_.append(text.data(), n);
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return;
  pid_ = 0;
  ended_early_ = true;
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

}  // namespace aurasim::launch
