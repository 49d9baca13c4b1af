// The process behind a client library (docs/client.md): uses DDS on behalf of the client, and ends with it.
#pragma once

#include <memory>
#include <vector>

#include "agent/run_link.h"
#include "client/message.h"
#include "steering/ask.h"

namespace aurasim::agent {

/// The asks in a client's message. Throws steering::BadAsk.
std::vector<steering::Ask> asks_of(const nlohmann::json& asked);

class Agent {
 public:
  /// `socket`: connection to the client.
  explicit Agent(int socket) : socket_(socket) {}

  /// Answers requests until the client closes or has gone. A run that the client has launched has ended by then, or is
  /// about to.
  void serve();

 private:
  void look();
  void reply(const client::Message& question);
  client::Message answer(const client::Message& question, const Patience& patience);
  client::Message answer_of_run(const std::string& what, const nlohmann::json& asked, const Patience& patience);
  client::Message answer_to_ask(const nlohmann::json& asked, const Patience& patience);
  client::Message answer_to_steer(const steering::Steer& steer, const Patience& patience);
  nlohmann::json open(const nlohmann::json& asked, const Patience& patience);
  void begin_paused(const Patience& patience);
  nlohmann::json close(const Patience& patience);
  RunLink& run();

  int socket_;
  std::unique_ptr<RunLink> run_;
  bool closing_ = false;
};

}  // namespace aurasim::agent
