// A child process that dies with its owner.
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace aurasim::dds::testing {

class Child {
 public:
  /// Starts `words[0]` with a pipe for its standard output.
  explicit Child(std::vector<std::string> words) {
    int ends[2];
    if (pipe(ends) != 0) {
      throw std::runtime_error("pipe");
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    std::vector<char*> arguments;
    for (auto& word : words) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    const int error = posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = ends[0];
    if (error != 0) {
      throw std::runtime_error("cannot start " + words[0]);
    }
  }
  ~Child() {
    kill(SIGKILL);
    close(output_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The next line of its output, without the line end; what there is of it at the end or after 20 s.
  std::string read_line() {
    constexpr int kTimeOutMs = 20'000;
    std::string line;
    pollfd ready{.fd = output_, .events = POLLIN, .revents = 0};
    char letter = 0;
    while (poll(&ready, 1, kTimeOutMs) == 1 && read(output_, &letter, 1) == 1 && letter != '\n') {
      line += letter;
    }
    return line;
  }

  void kill(int signal) {
    if (pid_ > 0) {
      ::kill(pid_, signal);
      if (signal == SIGKILL) {
        waitpid(pid_, nullptr, 0);
        pid_ = -1;
      }
    }
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
};

}  // namespace aurasim::dds::testing
