#include "dds/hub.h"

#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "aurasim.h"
#include "dds/endpoints.h"
#include "dds/introductions.h"
#include "dds/kept_samples.h"
#include "dds/participant.h"
#include "dds/participant_qos.h"

namespace aurasim::dds {
namespace {

/// Time that the samples of a gone writer stay. Readers on a busy host have received them by then.
constexpr std::chrono::seconds kUntilRead{5};

/// A UDP socket of the hub's own: its participant has no way to send a datagram of somebody else.
class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (fd_ < 0) throw DdsError("the hub cannot open a UDP socket");
  }
  ~Socket() { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  bool bind(const MeetingPoint& point) const {
    const ::sockaddr_in address = address_of(point);
    return ::bind(fd_, reinterpret_cast<const ::sockaddr*>(&address), sizeof address) == 0;  // NOLINT: as POSIX has it
  }
  /// A datagram that cannot be sent counts as lost: introductions are repeated.
  void send(const Introduction& introduction) const {
    const ::sockaddr_in address = address_of(introduction.to);
    ::sendto(fd_, introduction.announcement.data(), introduction.announcement.size(), 0,
             reinterpret_cast<const ::sockaddr*>(&address), sizeof address);  // NOLINT
  }

 private:
  static ::sockaddr_in address_of(const MeetingPoint& point) {
    ::sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(point.address);
    address.sin_port = htons(point.port);
    return address;
  }

  int fd_;
};

std::string why_no_second(const Settings& settings) {
  return fmt::format(
      "DDS domain {} already has a hub{} at {}, or another program has its UDP port {}, or this host has another "
      "address",
      settings.domain, settings.keys ? " with keys" : "", hub_address(settings), hub_port(settings));
}

/// A name on this host that one process has at a time. Fast DDS shares its ports, so two hubs that start in the same
/// moment would both find the port free. The kernel gives the name back when the process ends, however it ends.
class Claim {
 public:
  explicit Claim(const Settings& settings) : fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    ::sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = fmt::format("aurasim hub {} {}", hub_port(settings), hub_address(settings));
    name.copy(&address.sun_path[1], name.size());  // it begins with a zero byte: a name without a file
    const auto size = static_cast<::socklen_t>(offsetof(::sockaddr_un, sun_path) + 1 + name.size());
    if (fd_ >= 0 && ::bind(fd_, reinterpret_cast<const ::sockaddr*>(&address), size) == 0) return;  // NOLINT
    if (fd_ >= 0) ::close(fd_);
    throw DdsError(why_no_second(settings));
  }
  ~Claim() { ::close(fd_); }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

 private:
  int fd_;
};

MeetingPoint point_of(const Settings& settings) {
  ::in_addr address{};
  ::inet_pton(AF_INET, hub_address(settings).c_str(), &address);
  return {ntohl(address.s_addr), hub_port(settings)};
}

/// The settings of a hub, with introductions. Throws if the domain has one.
Settings checked(Settings settings) {
  if (Hub::is_there(settings)) {
    throw DdsError(why_no_second(settings));
  }
  settings.introductions = std::make_shared<Introductions>();
  return settings;
}

/// Partitions in which the hub publishes. Statuses are read by the name of their region as well as by a pattern.
/// Another vendor's reader that names a pattern does not match a writer that names one, so there is a name, too.
std::vector<std::string> partitions_of(TopicId topic, bool has_keys) {
  if (has_keys) return {topics::kFromHub};
  if (topic == TopicId::kNodeStatus) return {"region/*", "region/hub"};
  return {topics::kWorldPartition};
}

/// One topic's way through the hub.
struct Lane {
  Lane(Domain& domain, TopicId topic_in, std::size_t depth)
      : topic(topic_in),
        reader(domain, spec_of(topic, {topics::kEveryPartitionToHub}), domain.wakeup()),
        writer(domain, spec_of(topic, partitions_of(topic, domain.has_keys())), domain.wakeup()),
        kept(depth) {}

  static EndpointSpec spec_of(TopicId topic, std::vector<std::string> partitions) {
    EndpointSpec spec{topic, std::move(partitions), {}, {}};
    spec.is_of_hub = true;
    return spec;
  }

  TopicId topic;
  Reader reader;
  Writer writer;
  KeptSamples kept;
  std::uint64_t seen_changes = 0;                                   ///< of the reader's watch
  std::optional<std::chrono::steady_clock::time_point> forgets_at;  ///< when the gone are forgotten; nothing: nobody is
  std::uint64_t newest_generation = 0;                              ///< of checkpoints
};

}  // namespace

struct Hub::Impl {
  /// `settings`: checked.
  explicit Impl(const Settings& settings)
      : claim(settings), introductions(settings.introductions), participant(settings) {}

  void pass_on(Lane& lane);
  bool speaks_for_itself(const PassedSample& status);
  void pass_on_checkpoints(Lane& lane);
  void forget_the_gone(Lane& lane);
  void write(Lane& lane, const PassedSample& sample) {
    ++(lane.writer.pass_on(sample) == WriteResult::kFailed ? counts.failed : counts.passed);
  }

  Claim claim;
  std::shared_ptr<Introductions> introductions;
  Socket socket;
  Participant participant;
  // As deep as the histories of the writers whose samples they are.
  Lane statuses{participant.domain(), TopicId::kNodeStatus, 1};
  Lane maps{participant.domain(), TopicId::kRegionMap, 1};
  Lane commands{participant.domain(), TopicId::kRunControl, 256};
  Lane checkpoints{participant.domain(), TopicId::kCheckpoint, 0};
  Counts counts;
};

/// Passes on what has come, and keeps it for those who join later.
void Hub::Impl::pass_on(Lane& lane) {
  forget_the_gone(lane);
  for (;;) {
    PassedSample sample;
    sample.sample = lane.reader.make_sample();
    if (!lane.reader.take_sample(sample)) return;
    if (lane.topic == TopicId::kNodeStatus && !speaks_for_itself(sample)) {
      ++counts.refused;
      continue;
    }
    write(lane, sample);
    lane.kept.keep(std::move(sample));
  }
}

/// True if a status came in the partition of the region that it names. Those who get it from the hub do not know its
/// writer, so only the hub can tell. With keys this partition shows that the writer may publish as that region.
bool Hub::Impl::speaks_for_itself(const PassedSample& status) {
  const auto region = participant.domain().speakers().home_of(status.writer);
  return region == core::RegionId{static_cast<const wire::NodeStatus*>(status.sample.get())->source()};
}

/// A sample of a writer that is gone reaches nobody who joins later, as if the writer itself had published to all. It
/// stays for a while, since those who are there may not have it yet.
void Hub::Impl::forget_the_gone(Lane& lane) {
  const auto now = std::chrono::steady_clock::now();
  const std::uint64_t changes = lane.reader.watch().changes();
  if (std::exchange(lane.seen_changes, changes) != changes) lane.forgets_at = now + kUntilRead;
  if (!lane.forgets_at || now < *lane.forgets_at) return;
  lane.forgets_at.reset();
  std::set<Guid> live;
  for (const RemoteWriter& writer : lane.reader.watch().writers()) {
    if (writer.matched) live.insert(writer.guid);
  }
  if (!lane.kept.keep_only_of(live)) return;
  lane.writer.forget_all();
  for (const PassedSample& sample : lane.kept.all()) lane.writer.pass_on(sample);
}

/// Parts of the world that all go back to. Their writer's history keeps them; those for an earlier generation are of no
/// use any more.
void Hub::Impl::pass_on_checkpoints(Lane& lane) {
  PassedSample sample;
  sample.sample = lane.reader.make_sample();
  while (lane.reader.take_sample(sample)) {
    const std::uint64_t generation = static_cast<const wire::Checkpoint*>(sample.sample.get())->generation();
    if (generation < lane.newest_generation) continue;
    if (generation > std::exchange(lane.newest_generation, generation)) lane.writer.forget_all();
    write(lane, sample);
  }
}

Hub::Hub(Settings settings) : impl_(std::make_unique<Impl>(checked(std::move(settings)))) {}

Hub::~Hub() = default;

bool Hub::is_there(const Settings& settings) { return !Socket().bind(point_of(settings)); }

void Hub::turn(std::chrono::nanoseconds time_out) {
  Participant& participant = impl_->participant;
  participant.progress();
  participant.domain().wakeup().wait(time_out);
  participant.progress();
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  for (const Introduction& introduction : impl_->introductions->take_due(now)) impl_->socket.send(introduction);
  impl_->pass_on(impl_->commands);  // first: they are few, and all wait for them
  impl_->pass_on(impl_->maps);
  impl_->pass_on(impl_->statuses);
  impl_->pass_on_checkpoints(impl_->checkpoints);
}

Hub::Counts Hub::counts() const {
  Counts counts = impl_->counts;
  counts.pairs = impl_->introductions->pairs();
  return counts;
}

}  // namespace aurasim::dds
