#include "dds/command_bus.h"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include "aurasim.h"
#include "dds/command_codec.h"
#include "dds/endpoints.h"
#include "dds/random_id.h"

namespace aurasim::dds {
struct CommandServerEndpoint::Impl {
  Impl(Participant& participant_in, core::RegionId region_in, std::uint64_t map_version_in)
      : participant(participant_in),
        region(region_in),
        map_version(map_version_in),
        commands(participant.domain(), in_world(TopicId::kCommand), wakeup),
        replies(participant.domain(), in_world(TopicId::kCommandReply), wakeup) {}

  Participant& participant;
  core::RegionId region;
  std::uint64_t map_version;
  Wakeup wakeup;
  Reader commands;
  Writer replies;
  wire::Command command;  // reused
  wire::CommandReply reply;
  std::set<std::uint64_t> requests;
  WireErrors refused;
};

CommandServerEndpoint::CommandServerEndpoint(Participant& participant, core::RegionId region, std::uint64_t map_version)
    : impl_(std::make_unique<Impl>(participant, region, map_version)) {}

CommandServerEndpoint::~CommandServerEndpoint() = default;

void CommandServerEndpoint::use_map(std::uint64_t map_version) { impl_->map_version = map_version; }

std::vector<core::Command> CommandServerEndpoint::take() {
  std::vector<core::Command> commands;
  Expected expected;
  expected.map_version = impl_->map_version;
  while (impl_->commands.take(&impl_->command)) {
    auto decoded = decode(impl_->command, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      if (*error == WireError::kMapVersion || impl_->command.request() == 0) continue;  // not for us
      core::CommandReply refusal;
      refusal.request = impl_->command.request();
      refusal.outcome = core::Outcome::kRefused;
      refusal.text = "malformed: " + std::string(name_of(*error));
      reply(std::move(refusal));
    } else if (impl_->requests.insert(impl_->command.request()).second) {
      commands.push_back(std::move(std::get<core::Command>(decoded)));
    }
  }
  return commands;
}

void CommandServerEndpoint::reply(core::CommandReply reply) {
  reply.source = impl_->region;
  encode(reply, impl_->map_version, impl_->reply);
  impl_->replies.write(&impl_->reply);
}

const WireErrors& CommandServerEndpoint::refused() const { return impl_->refused; }

struct CommandClientEndpoint::Impl {
  explicit Impl(Participant& participant_in)
      : participant(participant_in),
        commands(participant.domain(), in_world(TopicId::kCommand), wakeup),
        replies(participant.domain(), in_world(TopicId::kCommandReply), wakeup),
        shapes(participant.domain(), in_world(TopicId::kShape), wakeup) {}

  Participant& participant;
  std::uint64_t sender = draw_id();
  Wakeup wakeup;
  Writer commands;
  Reader replies;
  Writer shapes;
  wire::Command command;  // reused
  wire::CommandReply reply;
  wire::MeshShape shape;
  std::set<std::uint64_t> brought;
};

CommandClientEndpoint::CommandClientEndpoint(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

CommandClientEndpoint::~CommandClientEndpoint() = default;

std::size_t CommandClientEndpoint::listeners() const {
  return std::min(impl_->commands.foreign_reader_count(), impl_->replies.watch().writers().size());
}

std::uint64_t CommandClientEndpoint::send(core::Command command, std::uint64_t map_version) {
  if (command.request == 0) command.request = draw_id();
  encode(command, impl_->sender, map_version, impl_->command);
  if (impl_->commands.write(&impl_->command) == WriteResult::kFailed) {
    throw DdsError("cannot send the command: topic command does not take it");
  }
  return command.request;
}

std::vector<core::CommandReply> CommandClientEndpoint::take() {
  std::vector<core::CommandReply> replies;
  while (impl_->replies.take(&impl_->reply)) {
    auto decoded = decode(impl_->reply, {});
    if (auto* reply = std::get_if<core::CommandReply>(&decoded)) replies.push_back(std::move(*reply));
  }
  return replies;
}

void CommandClientEndpoint::bring(std::uint64_t hash, const core::TriangleMesh& mesh) {
  if (!impl_->brought.insert(hash).second) return;
  encode(NamedMesh{hash, mesh}, impl_->shape);
  impl_->shapes.write(&impl_->shape);
}

void CommandClientEndpoint::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

}  // namespace aurasim::dds
