#include "client/connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <map>
#include <utility>

#include <aurasim/errors.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/last_words.h"

extern "C" {  // glibc 2.36 does not declare this extern "C" itself
#include <sys/pidfd.h>
}

extern char** environ;

namespace aurasim::client {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLookEvery = 100ms;
constexpr auto kGrace = 20s;  ///< waiting time beyond a request's time-out: the agent ends a late request itself
constexpr auto kPatienceWithItsEnd = 10s;
constexpr int kNap_ms = 100;
constexpr off_t kLongestLastWords_B = 4000;

template <class Kind>
[[noreturn]] void raise(const std::string& what) {
  throw Kind(what);
}

[[noreturn]] void raise_as(const std::string& kind, const std::string& what) {
  static const std::map<std::string, void (*)(const std::string&)> kinds = {{"bad_file", raise<BadFile>},
                                                                            {"no_such_run", raise<NoSuchRun>},
                                                                            {"run_differs", raise<RunDiffers>},
                                                                            {"launch_failed", raise<LaunchFailed>},
                                                                            {"timed_out", raise<TimedOut>},
                                                                            {"refused", raise<Refused>},
                                                                            {"ended", raise<Ended>},
                                                                            {"no_program", raise<NoProgram>}};
  const auto found = kinds.find(kind);
  if (found != kinds.end()) found->second(what);
  throw Error(what);
}

/// Limits a time-out to a valid range, also if it is NaN or infinite.
Connection::Seconds bounded(Connection::Seconds time_out) {
  constexpr Connection::Seconds longest(1e8);
  return time_out.count() >= 0 ? std::min(time_out, longest) : Connection::Seconds(0);
}

Clock::time_point after(Connection::Seconds time_out) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(bounded(time_out));
}

/// Gives the agent the default handling of signals, whatever ours is, and a process group of its own, so that Ctrl-C
/// for this program does not reach it.
class SpawnAttributes {
 public:
  SpawnAttributes() {
    ::posix_spawnattr_init(&attributes_);
    sigset_t usual, none;
    sigemptyset(&usual);
    sigemptyset(&none);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD}) sigaddset(&usual, signal);
    ::posix_spawnattr_setsigdefault(&attributes_, &usual);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnAttributes() { ::posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace

Connection::Connection(const std::string& program, const std::string& log, std::function<bool()> interrupted)
    : interrupted_(std::move(interrupted)), owner_(::getpid()) {
  log_ = log.empty() ? ::memfd_create("aurasim", MFD_CLOEXEC)
                     : ::open(log.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (log_ < 0) throw Error("cannot write the log " + log);
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    ::close(log_);
    throw Error("cannot open a pair of sockets");
  }
  socket_ = ends[0];
  start(program, ends[1]);
  ::close(ends[1]);
  if (pid_ > 0) return;
  ::close(socket_);
  ::close(log_);
  throw NoProgram("cannot start " + program);
}

void Connection::start(const std::string& program, int socket) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, log_, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, log_, STDERR_FILENO);
  const SpawnAttributes attributes;
  std::string path = program, command = "agent";
  std::array<char*, 3> words = {path.data(), command.data(), nullptr};
  if (::posix_spawn(&pid_, path.c_str(), &actions, attributes.get(), words.data(), environ) != 0) pid_ = 0;
  ::posix_spawn_file_actions_destroy(&actions);
}

Connection::~Connection() {
  if (::getpid() == owner_) {
    end(Clock::now() + kPatienceWithItsEnd);
    end_launcher(Clock::now() + kPatienceWithItsEnd);
  } else {
    if (socket_ >= 0) ::close(socket_);
    if (launcher_ >= 0) ::close(launcher_);
  }
  ::close(log_);
}

/// Watches the launcher by a pidfd. On a kernel without pidfds nothing is watched, and the launcher ends a moment after
/// an agent that dies.
void Connection::watch_launcher(pid_t launcher) {
  if (launcher > 0 && launcher_ < 0) launcher_ = ::pidfd_open(launcher, 0);
}

Message Connection::ask(Message question, Seconds time_out) {
  if (!is_open()) throw Ended("this world is closed");
  const std::uint64_t request = ++requests_;
  question.head["request"] = request;
  question.head["time_out_s"] = bounded(time_out).count();
  try {
    write_message(socket_, question);
    Message answer = read_answer(request, after(time_out) + kGrace);
    if (answer.head.contains("error")) raise_as(answer.head.value("error", ""), answer.head.value("what", ""));
    return answer;
  } catch (const ConnectionLost&) {
    const std::string words = last_words(log_, kLongestLastWords_B);
    end(Clock::now());
    throw Ended("the agent has ended" + (words.empty() ? "" : ". Its last words: " + words));
  }
}

/// Reads the answer to `request`. Skips the answer to an earlier request that was given up.
Message Connection::read_answer(std::uint64_t request, Clock::time_point deadline) {
  while (Clock::now() < deadline) {
    std::optional<Message> answer = read_message(socket_, Clock::now() + kLookEvery);
    if (answer && answer->head.value("request", std::uint64_t{0}) == request) return std::move(*answer);
    if (!answer && interrupted_ && interrupted_()) throw Interrupted("interrupted");
  }
  throw ConnectionLost("the agent is silent");
}

int Connection::close(Seconds time_out) {
  if (!is_open()) return end_launcher(after(time_out));
  int exit_code = 0;
  try {
    const std::function<bool()> until_then = std::exchange(interrupted_, {});
    exit_code = ask({{{"do", "close"}}, {}}, time_out).head.value("exit_code", 0);
  } catch (const Error&) {
  }
  end(Clock::now() + kPatienceWithItsEnd);
  const int of_agent = end_launcher(after(time_out));
  return exit_code != 0 ? exit_code : of_agent;
}

/// An agent that ends in order has waited for its launcher. One that dies takes the launcher with it (SIGTERM), and
/// that ends when all nodes have. Returns the agent's exit code, if there was a launcher.
int Connection::end_launcher(Clock::time_point deadline) {
  if (launcher_ < 0) return 0;
  pollfd its_end{launcher_, POLLIN, 0};
  bool is_over = false;
  while (!is_over && Clock::now() < deadline) is_over = ::poll(&its_end, 1, kNap_ms) > 0;
  if (!is_over) {
    ::pidfd_send_signal(launcher_, SIGKILL, nullptr, 0);
    ::poll(&its_end, 1, kNap_ms);
  }
  ::close(std::exchange(launcher_, -1));
  return exit_code_;
}

/// Ends the agent. It ends by itself when it sees that we are gone, and everything that it has started ends with it.
void Connection::end(Clock::time_point deadline) {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
  if (pid_ <= 0) return;
  int status = 0;
  while (::waitpid(pid_, &status, WNOHANG) == 0) {
    if (Clock::now() >= deadline) {
      ::kill(pid_, SIGKILL);
      while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
      }
      break;
    }
    const timespec nap{0, 2'000'000};
    ::nanosleep(&nap, nullptr);
  }
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  pid_ = 0;
}

}  // namespace aurasim::client
