// Commands of pages: asks of a run (steering/ask.h), and the interface that executes them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "steering/ask.h"

namespace aurasim::overseer {

/// Identifies one connection of one page. Never reused.
enum class ClientId : std::uint64_t {};

struct Request {
  ClientId client{};
  std::string id;  ///< chosen by the page; returned in the reply
  steering::Ask ask;
};

struct Reply {
  ClientId client{};
  std::string request;
  bool ok = false;
  std::string text;       ///< reason for a refusal, or description of what was done
  nlohmann::json result;  ///< null, or an object
};

/// Executes the commands of pages. Used by one thread, which also serves pages: nothing in here may block it.
class CommandSink {
 public:
  CommandSink() = default;
  virtual ~CommandSink() = default;
  CommandSink(const CommandSink&) = delete;
  CommandSink& operator=(const CommandSink&) = delete;

  /// Begins to execute a request. Each request gets exactly one reply, at once or later, in any order.
  virtual void submit(Request request) = 0;
  /// Continues the requests that have begun, and returns the replies that are ready. Called often.
  virtual std::vector<Reply> take_replies() = 0;
};

}  // namespace aurasim::overseer
