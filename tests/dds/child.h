// A child process that dies with its owner.
#pragma once

#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

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
    output_ = fdopen(ends[0], "r");
    if (error != 0) {
      throw std::runtime_error("cannot start " + words[0]);
    }
  }
  ~Child() {
    kill(SIGKILL);
    if (output_ != nullptr) {
      fclose(output_);
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The next line of its output, without the line end; empty when it has ended.
  std::string read_line() {
    char line[256];
    if (fgets(line, sizeof line, output_) == nullptr) {
      return {};
    }
    std::string text(line);
    return text.substr(0, text.find('\n'));
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
  FILE* output_ = nullptr;
};

}  // namespace aurasim::dds::testing
