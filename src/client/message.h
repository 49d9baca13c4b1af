// What a client library and its agent (cli/agent/) say to each other over a pair of sockets: a head in JSON and a body
// of bytes, in native byte order, for the two are always on one host.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace aurasim::client {

/// Changes with every change of what is said.
inline constexpr int kAgentProtocol = 3;

struct Message {
  nlohmann::json head;
  std::string body;
};

/// The other side has gone, or says what is no message.
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws ConnectionLost.
void write_message(int socket, const Message& message);

/// Nothing: none has begun to come before the deadline. Throws ConnectionLost, also when one stops in its middle.
std::optional<Message> read_message(int socket, std::chrono::steady_clock::time_point deadline);

/// Something has come, or the other side has gone, within that time.
bool is_readable(int socket, std::chrono::milliseconds time_out);

}  // namespace aurasim::client
