#include "client/message.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <poll.h>
#include <sys/socket.h>

namespace aurasim::client {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Frame {
  std::array<char, 4> what = {'a', 'u', 'r', 'a'};
  std::uint32_t head_B = 0;
  std::uint64_t body_B = 0;
};
static_assert(sizeof(Frame) == 16);

constexpr std::uint32_t kLongestHead_B = 64U << 20;
constexpr std::uint64_t kLongestBody_B = std::uint64_t{4} << 30;
constexpr auto kPatienceInAMessage = 10s;

void write_all(int socket, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::send(socket, bytes, count, MSG_NOSIGNAL);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw ConnectionLost("the other side has gone");
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

void read_all(int socket, char* bytes, std::size_t count, Clock::time_point deadline) {
  while (count > 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (!is_readable(socket, std::max(left, 0ms))) throw ConnectionLost("a message stops in its middle");
    const ssize_t got = ::recv(socket, bytes, count, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw ConnectionLost("the other side has gone");
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
}

}  // namespace

bool is_readable(int socket, std::chrono::milliseconds time_out) {
  pollfd wait{socket, POLLIN, 0};
  return ::poll(&wait, 1, static_cast<int>(std::min<std::int64_t>(time_out.count(), 1'000'000))) > 0;
}

void write_message(int socket, const Message& message) {
  const std::string head = message.head.dump();
  Frame frame;
  frame.head_B = static_cast<std::uint32_t>(head.size());
  frame.body_B = message.body.size();
  std::string start(sizeof frame, '\0');
  std::memcpy(start.data(), &frame, sizeof frame);
  start += head;
  write_all(socket, start.data(), start.size());
  write_all(socket, message.body.data(), message.body.size());
}

std::optional<Message> read_message(int socket, Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  if (!is_readable(socket, std::max(left, 0ms))) return std::nullopt;
  const auto end = Clock::now() + kPatienceInAMessage;
  Frame frame;
  read_all(socket, reinterpret_cast<char*>(&frame), sizeof frame, end);
  if (frame.what != Frame{}.what || frame.head_B > kLongestHead_B || frame.body_B > kLongestBody_B) {
    throw ConnectionLost("what came is no message");
  }
  std::string head(frame.head_B, '\0');
  read_all(socket, head.data(), head.size(), end);
  Message message;
  message.body.resize(frame.body_B);
  read_all(socket, message.body.data(), message.body.size(), end);
  message.head = nlohmann::json::parse(head, nullptr, false);
  if (!message.head.is_object()) throw ConnectionLost("what came is no message");
  return message;
}

}  // namespace aurasim::client
