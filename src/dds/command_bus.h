// Topics command, command_reply and shape: commands of clients, the replies of nodes, and the meshes that clients
// bring.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/command.h"
#include "core/scene.h"
#include "dds/participant.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

/// A node's endpoint: receives commands and replies to them. Used by one thread. The participant must outlive it.
class CommandServerEndpoint {
 public:
  /// Commands for other maps are refused and counted, until the map changes.
  CommandServerEndpoint(Participant& participant, core::RegionId region, std::uint64_t map_version);
  ~CommandServerEndpoint();

  void use_map(std::uint64_t map_version);
  /// Returns new commands in order of arrival, each request once. A client that repeats a request gets the last reply
  /// again: the first time, its reader may not have been matched yet.
  std::vector<core::Command> take();
  void reply(core::CommandReply reply);
  /// Forgets a request that was not executed here: if a client repeats it, take() returns it again.
  void forget(std::uint64_t request);

  const messages::WireErrors& refused() const;
  /// Number of commands dropped because their client sent more than 500 a second for long.
  std::uint64_t too_many() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A client's endpoint: sends commands and receives replies. Used by one thread. The participant must outlive it.
class CommandClientEndpoint {
 public:
  explicit CommandClientEndpoint(Participant& participant);
  ~CommandClientEndpoint();

  /// Number of nodes that are matched in both directions: they receive commands, and their replies arrive.
  std::size_t listeners() const;
  /// Sends a command. Draws a request id if it has none. Returns the request id. Throws DdsError when the write failed.
  std::uint64_t send(core::Command command, std::uint64_t map_version);
  std::vector<core::CommandReply> take();
  /// Publishes a mesh to all nodes, those that join later included, as long as this process lives. Throws DdsError when
  /// the write failed.
  void bring(std::uint64_t hash, const core::TriangleMesh& mesh);
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
