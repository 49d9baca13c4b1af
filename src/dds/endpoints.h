// A writer or reader with the publisher or subscriber that gives it its partitions. QoS comes from a profile, by name.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "core/ids.h"
#include "dds/domain.h"
#include "dds/kept_samples.h"
#include "dds/rising_time.h"
#include "dds/seen_numbers.h"
#include "dds/watch.h"
#include "messages/part_fields.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

struct EndpointSpec {
  TopicId topic = TopicId::kAura;
  std::vector<std::string> partitions;
  std::optional<core::RegionId> region;  ///< region whose endpoint this is; peers read it in the user data
  std::string profile = {};              ///< QoS profile; empty: the topic's
  /// For a reader: one that asks for no history (volatile) becomes best effort and gets no retransmissions, whatever
  /// its profile says.
  bool best_effort_if_volatile = false;
  /// For the endpoints of a hub: samples of many sources, which are passed on as they come. The history needs no room
  /// for parts of a message that the next one replaces.
  bool is_of_hub = false;
  /// For a reader: what comes has been passed on by a hub, because only a hub may publish in these partitions.
  bool is_from_hub = false;
};

/// Spec of an endpoint of `region`, or of nobody's, for the messages of a topic that go this route.
inline EndpointSpec on(TopicId topic, const topics::Route& route = {}, std::optional<core::RegionId> region = {}) {
  return {topic, {topics::partition_of(topic, route)}, region, {}};
}

enum class WriteResult : std::uint8_t { kSent, kSentAtSecondTry, kFailed };

/// A DDS writer. QoS by profile `<topic>_writer`, or as the spec says. A writer with MANUAL_BY_TOPIC liveliness is kept
/// alive by the domain's liveliness asserter. Several threads may write samples, and one of them messages in parts.
class Writer {
 public:
  Writer(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Writes one message. `sample` points to the generated type of the topic. A message that does not fit into a
  /// datagram is written in parts (parts.h).
  WriteResult write(void* sample);
  /// Largest serialized sample that fits into a datagram, with its encapsulation.
  std::uint32_t largest_sample_B() const;
  /// Writes a sample of another writer, with its number. For a hub.
  WriteResult pass_on(const PassedSample& passed);
  /// Drops all samples from the history, also those that some readers have not acknowledged. Call it before write()
  /// where the newest message of a writer replaces all earlier ones.
  void forget_all();
  /// Drops all samples from the history if every reader has acknowledged all of them. Returns how many samples there
  /// were. Names a reader in the log that has acknowledged nothing for as many calls as the history is deep. Only for
  /// volatile writers used by the caller's thread alone. Needed because Fast DDS 2.9 never drops samples that a reader
  /// had yet to acknowledge when another reader was matched; each heartbeat then lists all gaps after them one by one.
  std::size_t forget_acknowledged();
  /// True when every matched reader has acknowledged every sample. Does not wait.
  bool all_acknowledged();
  /// True when a reader of `region` is matched.
  bool reaches(core::RegionId region) const;
  std::size_t reader_count() const { return watch_.readers().size(); }
  /// Number of readers matched so far, those that left again included.
  std::uint64_t matches() const { return watch_.matches(); }
  /// Matched readers in other processes.
  std::size_t foreign_reader_count() const;
  const Guid& guid() const { return writer_->guid(); }

 private:
  void say_who_does_not_read();
  WriteResult write_in_two_tries(void* sample, eprosima::fastrtps::rtps::WriteParams& params);
  WriteResult write_sample(void* sample);
  WriteResult write_parts(void* message, std::uint32_t message_B);

  Domain& domain_;
  eprosima::fastdds::dds::TypeSupport type_;
  const messages::PartFields* part_fields_ = nullptr;  ///< null: the topic's messages always fit into a datagram
  std::shared_ptr<void> part_;                         ///< sample, reused
  std::uint64_t messages_in_parts_ = 0;
  WriterWatch watch_;
  bool is_of_nodes_ = false;                        ///< its samples are messages between nodes
  bool goes_by_hub_ = false;                        ///< a hub passes its samples on
  LivelinessAsserter::Nanoseconds written_ns_ = 0;  ///< when the last sample was written
  std::mutex writing_;                              ///< the times of samples have to rise with their numbers
  RisingTime sent_;
  std::int32_t unread_ = 0;  ///< calls of forget_acknowledged() since every reader had acknowledged everything
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
};

/// Origin of a received sample.
struct Origin {
  Guid writer;
  bool by_hub = false;           ///< it came by a hub: this process need not know the writer's process
  std::int64_t received_ns = 0;  ///< when: wall clock, nanoseconds since 1970
  /// How far the sender's wall clock is ahead of the own one, less the transit time: its time of sending minus our time
  /// of receipt. Of a message that came by a hub: the hub's clock, unless the message says when it was sent.
  std::chrono::nanoseconds clock_ahead{0};

  /// Sets clock_ahead by what a message says. `sent_ns`: wall clock of its sender; 0 or less: it says nothing.
  void heed(std::int64_t sent_ns) {
    if (sent_ns > 0) clock_ahead = std::chrono::nanoseconds(sent_ns - received_ns);
  }
};

/// A DDS reader. QoS by profile `<topic>_reader`, or as the spec says.
class Reader {
 public:
  /// `on_data`, if not empty, is called by DDS threads when samples have come; the owner is not woken then. It may take
  /// samples and write, and must not make or remove endpoints.
  Reader(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup, std::function<void()> on_data = {});
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Takes the next message into `sample` (the generated type). False when there is none. Of a message in parts the
  /// origin is that of the last part.
  bool take(void* sample, Origin* origin = nullptr);
  /// Takes the next sample, a message or a part of one, into `taken.sample`. For a hub.
  bool take_sample(PassedSample& taken);
  /// A sample of the topic's generated type.
  std::shared_ptr<void> make_sample();
  /// Messages lost since the last call, because parts of them are missing or do not fit together.
  std::uint64_t take_lost();

  /// Refuses a taken sample. Counted against its sender only if it is no message of this program at all. Other
  /// versions, runs and maps, and what a person has typed, are not counted as the sender's fault.
  void refuse_from(const Origin& origin, messages::WireError error);
  /// Refuses a taken sample that its sender had no right to send, and counts it against the sender. `what` names the
  /// message.
  void refuse_from(const Origin& origin, const std::string& what);
  /// Drops a taken sample because its sender exceeds a rate limit. `what`: the limit, for the log.
  void ration(const Origin& origin, const std::string& what);

  const ReaderWatch& watch() const { return watch_; }
  /// Writers in order of match, then the hubs that are heard by a reader of their own (with keys). Those that are gone
  /// are kept.
  std::vector<RemoteWriter> writers() const;
  /// Number of their matches, ends of matches, and changes of a proof of life so far.
  std::uint64_t changes() const { return watch_.changes() + (from_hub_ == nullptr ? 0 : from_hub_->changes()); }
  /// How long a writer is silent before that is believed: one and a half leases.
  std::chrono::nanoseconds believed_silence() const { return believed_silence_; }
  /// Partitions of the reader, from its QoS.
  std::vector<std::string> partitions() const;

 private:
  void look_for_hub();
  bool take_own(void* sample, Origin* origin);
  bool put_together(void* sample, const messages::Part& part, const Guid& writer);

  Domain& domain_;
  eprosima::fastdds::dds::TypeSupport type_;
  const messages::PartFields* part_fields_ = nullptr;  ///< null: the topic's messages never come in parts
  std::uint64_t lost_ = 0;
  Wakeup& wakeup_;
  bool is_from_hub_ = false;
  std::chrono::nanoseconds believed_silence_{0};
  SeenNumbers by_hub_;
  std::optional<EndpointSpec> spec_from_hub_;  ///< nothing: a hub does not pass on such messages, or they are read
  std::unique_ptr<Reader> from_hub_;           ///< of what a hub passes on in a run with keys
  ReaderWatch watch_;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;
};

}  // namespace aurasim::dds
