// Topics command, command_reply and shape: what clients ask of a run, the replies, the meshes that they bring.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/command.h"
#include "core/scene.h"
#include "dds/participant.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

/// The end of a node. Used by one thread. The participant must outlive it.
class CommandServerEndpoint {
 public:
  /// Commands for other maps are refused and counted, until the map changes.
  CommandServerEndpoint(Participant& participant, core::RegionId region, std::uint64_t map_version);
  ~CommandServerEndpoint();

  void use_map(std::uint64_t map_version);
  /// New ones, in order of arrival; each request once. Who asks again is told again what it was told last: its reader
  /// may have been unknown here when the reply was sent.
  std::vector<core::Command> take();
  void reply(core::CommandReply reply);
  /// It was not obeyed here: if somebody asks again, it is new.
  void forget(std::uint64_t request);

  const WireErrors& refused() const;
  /// Commands that were dropped, since their client sent more than 500 a second for long.
  std::uint64_t too_many() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The end of a client. Used by one thread. The participant must outlive it.
class CommandClientEndpoint {
 public:
  explicit CommandClientEndpoint(Participant& participant);
  ~CommandClientEndpoint();

  /// How many nodes take commands and can answer.
  std::size_t listeners() const;
  /// Draws a request id if there is none, and returns it. Throws DdsError when the write failed.
  std::uint64_t send(core::Command command, std::uint64_t map_version);
  std::vector<core::CommandReply> take();
  /// Gives a mesh to all nodes, now and later, as long as this process lives. Throws DdsError when the write failed.
  void bring(std::uint64_t hash, const core::TriangleMesh& mesh);
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
