// Messages between a client library and its agent (agent/) over a pair of sockets: a head in JSON and a body of
// bytes. The byte order is native, because both are always on one host.
#pragma once

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace aurasim::client {

/// Version of these messages. Changes with every change of them.
inline constexpr int kAgentProtocol = 4;

struct Message {
  nlohmann::json head;
  std::string body;
};

/// The other side is gone, or has sent an invalid message.
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sends a message. Throws ConnectionLost.
void write_message(int socket, const Message& message);

/// Receives a message. Nothing: none had begun to arrive before the deadline. Throws ConnectionLost, also when a
/// message stops in its middle.
std::optional<Message> read_message(int socket, std::chrono::steady_clock::time_point deadline);

/// True when within that time something has arrived or the other side has gone.
bool is_readable(int socket, std::chrono::milliseconds time_out);

}  // namespace aurasim::client
