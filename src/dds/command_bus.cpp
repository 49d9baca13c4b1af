#include "dds/command_bus.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "dds/random_id.h"
#include "dds/rations.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
namespace {

/// Number of requests that a node remembers: more than all clients together have under way.
constexpr std::size_t kRemembered = 1U << 16U;

/// Remembers received requests and the last reply to each.
class Requests {
 public:
  /// Adds a request. Returns false if it is known already.
  bool add(std::uint64_t request) {
    if (!last_reply_.try_emplace(request).second) return false;
    order_.push_back(request);
    if (order_.size() > kRemembered) {
      last_reply_.erase(order_.front());
      order_.pop_front();
    }
    return true;
  }

  void note(const core::CommandReply& reply) {
    const auto known = last_reply_.find(reply.request);
    if (known != last_reply_.end()) known->second = reply;
  }

  void forget(std::uint64_t request) {
    if (last_reply_.erase(request) > 0) std::erase(order_, request);
  }

  std::optional<core::CommandReply> last_reply(std::uint64_t request) const { return last_reply_.at(request); }

 private:
  std::map<std::uint64_t, std::optional<core::CommandReply>> last_reply_;
  std::deque<std::uint64_t> order_;
};

}  // namespace

struct CommandServerEndpoint::Impl {
  Impl(Participant& participant_in, core::RegionId region_in, std::uint64_t map_version_in)
      : participant(participant_in),
        region(region_in),
        map_version(map_version_in),
        wakeup(participant.domain().wakeup()),
        commands(participant.domain(), on(TopicId::kCommand), wakeup),
        replies(participant.domain(), on(TopicId::kCommandReply), wakeup) {}

  Participant& participant;
  core::RegionId region;
  std::uint64_t map_version;
  Wakeup& wakeup;
  TypedReader<wire::Command> commands;
  TypedWriter<wire::CommandReply> replies;
  Requests requests;
  std::uint64_t too_many = 0;
  RateLimit<ProcessPrefix> rays{kWordsASecond, kWordsAtOnce}, others{kWordsASecond, kWordsAtOnce};
};

CommandServerEndpoint::CommandServerEndpoint(Participant& participant, core::RegionId region, std::uint64_t map_version)
    : impl_(std::make_unique<Impl>(participant, region, map_version)) {}

CommandServerEndpoint::~CommandServerEndpoint() = default;

void CommandServerEndpoint::use_map(std::uint64_t map_version) { impl_->map_version = map_version; }

std::vector<core::Command> CommandServerEndpoint::take() {
  std::vector<core::Command> commands;
  messages::Expected expected;
  expected.map_version = impl_->map_version;
  const auto now = std::chrono::steady_clock::now();
  const auto take_new = [&](core::Command&& command, const Origin& origin) {
    auto& limit = std::holds_alternative<core::Ray>(command.ask) ? impl_->rays : impl_->others;
    if (!limit.allows(origin.writer.guidPrefix, now)) {  // a repeated request may be accepted later
      ++impl_->too_many;
      impl_->commands.ration(origin, words_of_ration());
      return;
    }
    if (impl_->requests.add(command.request)) {
      commands.push_back(std::move(command));
    } else if (const auto known = impl_->requests.last_reply(command.request)) {
      reply(*known);
    }
  };
  const auto refuse = [&](const wire::Command& malformed, messages::WireError error) {
    if (error == messages::WireError::kMapVersion || malformed.request() == 0) return;  // not for us
    core::CommandReply refusal;
    refusal.request = malformed.request();
    refusal.outcome = core::Outcome::kRefused;
    refusal.text = "malformed: " + std::string(name_of(error));
    reply(std::move(refusal));
  };
  impl_->commands.take_each(expected, take_new, refuse);
  return commands;
}

void CommandServerEndpoint::reply(core::CommandReply reply) {
  reply.source = impl_->region;
  impl_->requests.note(reply);
  impl_->replies.send(reply, impl_->map_version);
}

void CommandServerEndpoint::forget(std::uint64_t request) { impl_->requests.forget(request); }

std::uint64_t CommandServerEndpoint::too_many() const { return impl_->too_many; }

const messages::WireErrors& CommandServerEndpoint::refused() const { return impl_->commands.refused(); }

struct CommandClientEndpoint::Impl {
  explicit Impl(Participant& participant_in)
      : participant(participant_in),
        wakeup(participant.domain().wakeup()),
        commands(participant.domain(), on(TopicId::kCommand), wakeup),
        replies(participant.domain(), on(TopicId::kCommandReply), wakeup),
        shapes(participant.domain(), on(TopicId::kShape), wakeup) {}

  Participant& participant;
  std::uint64_t sender = draw_id();
  Wakeup& wakeup;
  TypedWriter<wire::Command> commands;
  TypedReader<wire::CommandReply> replies;
  TypedWriter<wire::MeshShape> shapes;
};

CommandClientEndpoint::CommandClientEndpoint(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

CommandClientEndpoint::~CommandClientEndpoint() = default;

std::size_t CommandClientEndpoint::listeners() const {
  return std::min(impl_->commands.foreign_reader_count(), impl_->replies.watch().writers().size());
}

std::uint64_t CommandClientEndpoint::send(core::Command command, std::uint64_t map_version) {
  if (command.request == 0) command.request = draw_id();
  if (impl_->commands.send(command, impl_->sender, map_version) == WriteResult::kFailed) {
    throw DdsError("cannot send the command: topic command does not take it");
  }
  return command.request;
}

std::vector<core::CommandReply> CommandClientEndpoint::take() {
  std::vector<core::CommandReply> replies;
  impl_->replies.take_all({}, replies);
  return replies;
}

void CommandClientEndpoint::bring(std::uint64_t hash, const core::TriangleMesh& mesh) {
  if (impl_->shapes.send(messages::NamedMesh{hash, mesh}) == WriteResult::kFailed) {
    throw DdsError("cannot send the mesh: topic shape takes no more from this process");
  }
}

void CommandClientEndpoint::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

}  // namespace aurasim::dds
