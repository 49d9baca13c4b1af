#include "process.h"

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace aurasim::system_test {
namespace {

/// In the child, between fork and exec: only what is safe there.
[[noreturn]] void become(char* const* words, const char* out, const char* err, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  const int nothing = ::open("/dev/null", O_RDONLY);
  const int out_file = ::open(out, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int err_file = ::open(err, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(out_file, STDOUT_FILENO);
  ::dup2(err_file, STDERR_FILENO);
  ::execv(words[0], words);
  ::_exit(127);
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<pid_t> children_of(pid_t pid) {
  std::vector<pid_t> children;
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task", gone)) {
    std::istringstream in(read_text(task.path() / "children"));
    for (pid_t child = 0; in >> child;) children.push_back(child);
  }
  return children;
}

std::vector<std::string> command_line_of(pid_t pid) {
  std::istringstream in(read_text("/proc/" + std::to_string(pid) + "/cmdline"));
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  return words;
}

void adopt_orphans() { ::prctl(PR_SET_CHILD_SUBREAPER, 1); }

std::vector<std::string> end_all_children() {
  std::vector<std::string> ended;
  for (;;) {  // who loses its parent becomes our child: until there are none
    const std::vector<pid_t> children = children_of(::getpid());
    if (children.empty()) return ended;
    for (const pid_t child : children) {
      if (::waitpid(child, nullptr, WNOHANG) == child) continue;
      ended.push_back(joined(command_line_of(child)));
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
    }
  }
}

Process::Process(std::vector<std::string> words, const std::filesystem::path& output_prefix)
    : words_(std::move(words)), out_(output_prefix.string() + ".out"), err_(output_prefix.string() + ".err") {
  std::vector<char*> arguments;
  for (std::string& word : words_) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("cannot start " + words_[0]);
  if (pid_ == 0) become(arguments.data(), out_.c_str(), err_.c_str(), parent);
  ::setpgid(pid_, pid_);  // whoever of the two comes first
}

Process::~Process() {
  if (!running()) return;
  ::kill(-pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

bool Process::running() {
  if (exit_code_) return false;
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return true;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return false;
}

void Process::signal(int signal) {
  if (running()) ::kill(pid_, signal);
}

std::optional<int> Process::wait(Clock::duration time_out) {
  wait_until([this] { return !running(); }, time_out);
  return exit_code_;
}

std::string Process::said() const { return "$ " + joined(words_) + "\n-- stdout\n" + out() + "\n-- stderr\n" + err(); }

}  // namespace aurasim::system_test
