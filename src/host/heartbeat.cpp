#include "host/heartbeat.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace aurasim::host {
namespace {

using namespace std::chrono_literals;

constexpr auto kShortestPatience = 3s;  // signs come every quarter second
constexpr int kTimesTheLongestGap = 4;
constexpr auto kOfLate = 30s;
constexpr auto kLongGap = 500ms;  // between two signs, or two looks
constexpr const char* kOption = "--heartbeat";

bool is_pipe(int fd) {
  struct stat found {};
  return fd >= 0 && ::fstat(fd, &found) == 0 && S_ISFIFO(found.st_mode);
}

}  // namespace

void LifeWatch::look(Clock::time_point now) {
  if (looked_ && now - *looked_ > kLongGap) {
    for (auto& [process, heard] : heard_) heard += now - *looked_;
  }
  looked_ = now;
  while (!gaps_.empty() && gaps_.front().first < now - kOfLate) gaps_.pop_front();
}

void LifeWatch::note(pid_t process, Clock::time_point now) {
  const auto [known, is_first] = heard_.try_emplace(process, now);
  if (!is_first && now - known->second > kLongGap) gaps_.emplace_back(now, now - known->second);
  known->second = now;
}

LifeWatch::Clock::duration LifeWatch::patience() const {
  Clock::duration longest{0};
  for (const auto& [ended, gap] : gaps_) longest = std::max(longest, gap);
  return std::max<Clock::duration>(kShortestPatience, kTimesTheLongestGap * longest);
}

std::optional<LifeWatch::Clock::duration> LifeWatch::silence_of(pid_t process, Clock::time_point now) const {
  const auto known = heard_.find(process);
  if (known == heard_.end() || now - known->second <= patience()) return std::nullopt;
  return now - known->second;
}

HeartbeatPipe::HeartbeatPipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("cannot open a pipe");
  read_ = ends[0];
  write_ = ends[1];
  ::fcntl(write_, F_SETFD, 0);  // started processes inherit it
}

HeartbeatPipe::~HeartbeatPipe() {
  ::close(read_);
  ::close(write_);
}

std::vector<std::string> HeartbeatPipe::words() const { return {kOption, std::to_string(write_)}; }

/// Reads the process numbers in the pipe. Each process writes its number in one piece.
std::vector<pid_t> HeartbeatPipe::take() {
  std::vector<pid_t> heard;
  std::array<pid_t, 256> space{};
  for (;;) {
    const ssize_t octets = ::read(read_, space.data(), sizeof(space));
    if (octets <= 0) break;
    heard.insert(heard.end(), space.begin(), space.begin() + octets / static_cast<ssize_t>(sizeof(pid_t)));
  }
  std::ranges::sort(heard);
  const auto twice = std::ranges::unique(heard);
  heard.erase(twice.begin(), twice.end());
  return heard;
}

Heartbeat::Heartbeat(int pipe) : pipe_(is_pipe(pipe) ? pipe : -1) {}

void Heartbeat::beat() const {
  if (pipe_ < 0) return;
  const pid_t self = ::getpid();
  // Errors are ignored: a full pipe holds enough signs, and a pipe without a reader needs none.
  [[maybe_unused]] const ssize_t octets = ::write(pipe_, &self, sizeof(self));
}

void keep_heartbeat(const std::vector<std::string>& words) {
  const auto option = std::ranges::find(words, kOption);
  if (option == words.end() || option + 1 == words.end()) return;
  const std::string& number = *(option + 1);
  int pipe = -1;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), pipe);
  if (error == std::errc{} && end == number.data() + number.size() && is_pipe(pipe)) ::fcntl(pipe, F_SETFD, 0);
}

}  // namespace aurasim::host
