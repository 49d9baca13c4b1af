// A program under test: started in a process group of its own, its output caught in files, ended by its id.
#pragma once

#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace aurasim::system_test {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// How long a test waits for what happens at once on a machine that has nothing else to do. What has to be quick is
/// measured in tests/bench.
inline constexpr auto kGenerous = 60s;

/// Asks `condition` again and again until it holds; false when it does not within `time_out`.
template <class Condition>
bool wait_until(Condition&& condition, Clock::duration time_out) {
  const auto deadline = Clock::now() + time_out;
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    ::timespec nap{0, 5'000'000};
    ::nanosleep(&nap, nullptr);
  }
  return true;
}

/// The whole text of a file; empty if there is none.
std::string read_text(const std::filesystem::path& file);

/// Processes that `pid` has started and not yet seen the end of.
std::vector<pid_t> children_of(pid_t pid);
/// The words of a process's command line; empty when it has ended.
std::vector<std::string> command_line_of(pid_t pid);

/// Makes this process the parent of whatever outlives its own parent below it, so that nothing can be left unseen.
void adopt_orphans();
/// Kills and reaps everything below this process; returns the command lines of what was still running.
std::vector<std::string> end_all_children();

class Process {
 public:
  /// Starts `words[0]`. Its output goes to `output_prefix`.out and `output_prefix`.err. It is killed if this process
  /// dies, and when this object ends. Throws std::runtime_error when there can be no new process.
  Process(std::vector<std::string> words, const std::filesystem::path& output_prefix);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  bool running();
  void signal(int signal);

  /// Its exit code, or 128 + the signal that ended it. Nothing: it still runs after `time_out`.
  std::optional<int> wait(Clock::duration time_out);

  std::string out() const { return read_text(out_); }
  std::string err() const { return read_text(err_); }
  /// For the message of a failed check.
  std::string said() const;

 private:
  std::vector<std::string> words_;
  std::filesystem::path out_, err_;
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

}  // namespace aurasim::system_test
