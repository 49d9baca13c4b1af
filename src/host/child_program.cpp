#include "host/child_program.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace aurasim::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNiceness = 10;  // nodes on the same host come first

// Sanitizers reserve more address space than any limit allows.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

/// One end of a pipe. The destructor closes it.
class PipeEnd {
 public:
  PipeEnd() = default;
  explicit PipeEnd(int fd) : fd_(fd) {}
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;
  ~PipeEnd() { close(); }
  void open(int fd) { fd_ = fd; }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  int fd() const { return fd_; }

 private:
  int fd_ = -1;
};

struct Pipe {
  PipeEnd read, write;
  Pipe() {
    std::array<int, 2> ends{};
    // O_CLOEXEC, so that children started by other threads at this moment do not hold the pipe open.
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot open a pipe");
    read.open(ends[0]);
    write.open(ends[1]);
  }
};

void limit(int what, std::size_t value) {
  const rlimit both{value, value};
  ::setrlimit(what, &both);
}

/// Runs between fork and exec. It may only call what is safe while other threads hold locks.
[[noreturn]] void become(const ChildProgram& program, char* const* arguments, int input, int output) {
  ::setpgid(0, 0);  // this terminal's Ctrl-C does not reach it
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::setpriority(PRIO_PROCESS, 0, kNiceness);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<std::size_t>(program.limit.count() / 1000 + 1));
  if (kLimitsMemory) limit(RLIMIT_AS, program.most_memory);
  ::dup2(input, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::execv(arguments[0], arguments);
  ::_exit(127);
}

/// Writes the input and reads the output until the child closes it. Fails if that takes too long or is too much.
class Talk {
 public:
  Talk(Pipe& to_child, Pipe& from_child, std::string_view input, std::string& output)
      : to_child_(to_child), from_child_(from_child), input_(input), output_(output) {
    ::fcntl(to_child_.write.fd(), F_SETFL, O_NONBLOCK);
  }

  bool hold(Clock::time_point deadline, std::size_t most_output) {
    for (bool listening = true; listening;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
      if (left.count() <= 0 || output_.size() > most_output) return false;
      std::array<pollfd, 2> waits = {
          {{from_child_.read.fd(), POLLIN, 0}, {to_child_.write.fd(), POLLOUT, 0}}};  // poll ignores -1
      ::poll(waits.data(), waits.size(), static_cast<int>(left.count()) + 1);
      if (waits[1].revents != 0) feed();
      if (waits[0].revents != 0) listening = listen();
    }
    return true;
  }

 private:
  void feed() {
    const ssize_t written = ::write(to_child_.write.fd(), input_.data(), input_.size());
    if (written > 0) input_.remove_prefix(static_cast<std::size_t>(written));
    const bool refused = written < 0 && errno != EAGAIN && errno != EINTR;
    if (input_.empty() || refused) to_child_.write.close();
  }

  bool listen() {
    std::array<char, 65536> some{};
    const ssize_t count = ::read(from_child_.read.fd(), some.data(), some.size());
    if (count > 0) output_.append(some.data(), static_cast<std::size_t>(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }

  Pipe& to_child_;
  Pipe& from_child_;
  std::string_view input_;
  std::string& output_;
};

/// Exit status of the child. It may still run after it has closed its output, so the deadline holds here, too.
int status_of(pid_t pid, Clock::time_point deadline) {
  int status = 0;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    if (Clock::now() >= deadline) ::kill(pid, SIGKILL);
    ::poll(nullptr, 0, 1);
  }
  return status;
}

}  // namespace

ChildResult run_child(const ChildProgram& program, std::string_view input) {
  std::vector<std::string> words = program.words;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  Pipe to_child, from_child;
  const Clock::time_point deadline = Clock::now() + program.limit;
  const pid_t pid = ::fork();
  if (pid < 0) throw std::runtime_error("cannot start a process");
  if (pid == 0) become(program, arguments.data(), to_child.read.fd(), from_child.write.fd());
  to_child.read.close();
  from_child.write.close();
  ChildResult result;
  // SIGPIPE is blocked, so that a child that ends before it has read everything does not end this process.
  sigset_t pipe_signal, before;
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
  result.timed_out = !Talk(to_child, from_child, input, result.output).hold(deadline, program.most_output);
  const int status = status_of(pid, result.timed_out ? Clock::time_point{} : deadline);
  const timespec at_once{};
  ::sigtimedwait(&pipe_signal, nullptr, &at_once);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

}  // namespace aurasim::host
