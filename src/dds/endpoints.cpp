#include "dds/endpoints.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/wall_clock.h"
#include "dds/hub_qos.h"
#include "dds/many_nodes.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DataReaderQos;
using eprosima::fastdds::dds::DataWriterQos;
using eprosima::fastdds::dds::PublisherQos;
using eprosima::fastdds::dds::SampleInfo;
using eprosima::fastdds::dds::StatusMask;
using eprosima::fastdds::dds::SubscriberQos;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

void set_partitions(eprosima::fastdds::dds::PartitionQosPolicy& policy, const std::vector<std::string>& partitions) {
  policy.clear();
  for (const auto& partition : partitions) {
    policy.push_back(partition.c_str());
  }
}

std::string profile_of(const EndpointSpec& spec, const char* kind) {
  return spec.profile.empty() ? std::string(name_of(spec.topic)) + kind : spec.profile;
}

bool is_of_nodes(TopicId topic) { return topic == TopicId::kAura || topic == TopicId::kMigration; }

/// Bytes that a datagram has beside the payload of a sample: RTPS header, destination, time, heartbeat, statistics, and
/// the head of the sample.
constexpr std::uint32_t kHeaders_B = 200;
/// Bytes that a hub adds: the id and number of the original.
constexpr std::uint32_t kOriginal_B = 64;
/// Bytes that keys add: heads and authentication code of the encrypted submessage, and one more code for each reader.
constexpr std::uint32_t kCryptoHeaders_B = 128, kCryptoOfAReader_B = 20;
/// Readers of a hub, besides those of the nodes: spares, and processes that are about to take a region over.
constexpr std::size_t kReadersBesideNodes = 8;
/// A sample has at least this share of a datagram, with keys and without.
constexpr std::uint32_t kLeastShareWithKeys = 4, kLeastShare = 2;

std::uint32_t least_sample_B(const Domain& domain) {
  return domain.datagram_B() / (domain.has_keys() ? kLeastShareWithKeys : kLeastShare);
}

const messages::PartFields* part_fields_of(const eprosima::fastdds::dds::TypeSupport& type) {
  const auto* const has_fields = dynamic_cast<const messages::HasPartFields*>(type.get());
  return has_fields == nullptr ? nullptr : has_fields->part_fields();
}

/// Depth of a history that keeps the last samples: as in the profile, but enough for the parts of the largest message.
std::int32_t depth_of(const eprosima::fastdds::dds::HistoryQosPolicy& history, const Domain& domain) {
  const std::uint32_t parts = messages::parts_of(messages::kLargestMessage_B, least_sample_B(domain));
  return std::max(history.depth, static_cast<std::int32_t>(parts));
}

bool keeps_last(const eprosima::fastdds::dds::HistoryQosPolicy& history) {
  return history.kind == eprosima::fastdds::dds::KEEP_LAST_HISTORY_QOS;
}

void make_room_for_parts(DataWriterQos& qos, const Domain& domain) {
  if (!keeps_last(qos.history())) return;
  auto& limits = qos.resource_limits();
  qos.history().depth = limits.max_samples_per_instance = depth_of(qos.history(), domain);
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  limits.max_samples =
      static_cast<std::int32_t>(std::min(kMost, std::int64_t{limits.max_instances} * limits.max_samples_per_instance));
}

/// Entity id as one number, in the form in which the guard reads it from the wire.
std::uint32_t entity_of(const Guid& endpoint) {
  std::uint32_t entity = 0;
  for (const unsigned char octet : endpoint.entityId.value) entity = entity << 8 | octet;
  return entity;
}

/// Makes a time of a profile at least so long.
void be_patient(eprosima::fastrtps::Duration_t& time, std::chrono::nanoseconds shortest) {
  if (shortest.count() > time.to_ns())
    time = eprosima::fastrtps::Duration_t(std::chrono::duration<double>(shortest).count());
}

bool goes_by_hub(const EndpointSpec& spec) {
  return std::ranges::any_of(spec.partitions,
                             [&](const std::string& name) { return topics::goes_by_hub(spec.topic, name); });
}

/// Partitions of a writer: those of its messages to all are the hub's, if there is one.
std::vector<std::string> by_hub_if_needed(const Domain& domain, const EndpointSpec& spec) {
  std::vector<std::string> partitions = spec.partitions;
  if (!domain.speaks_by_hub()) return partitions;
  for (std::string& partition : partitions) {
    if (topics::goes_by_hub(spec.topic, partition)) partition = topics::to_hub(partition);
  }
  return partitions;
}

/// Spec of a reader of what a hub passes on in a run with keys. Nothing: it passes on no such messages.
std::optional<EndpointSpec> spec_from_hub(const EndpointSpec& spec) {
  if (!goes_by_hub(spec) || spec.is_of_hub || spec.is_from_hub) return std::nullopt;
  EndpointSpec from_hub = spec;
  from_hub.partitions = {topics::kFromHub};
  from_hub.region.reset();
  from_hub.is_from_hub = true;
  return from_hub;
}

[[noreturn]] void throw_not_created(const char* what, const EndpointSpec& spec) {
  throw DdsError(fmt::format("cannot create the {} of topic {} in partition {} (Fast DDS says more on standard error)",
                             what, name_of(spec.topic), fmt::join(spec.partitions, ", ")));
}

}  // namespace

Writer::Writer(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup)
    : domain_(domain),
      type_(domain.participant().find_type(domain.topic(spec.topic).get_type_name())),
      part_fields_(part_fields_of(type_)),
      watch_(wakeup),
      is_of_nodes_(is_of_nodes(spec.topic)),
      goes_by_hub_(domain.speaks_by_hub() && goes_by_hub(spec)) {
  auto& topic = domain.topic(spec.topic);
  const auto stopped = domain.guard().delivery().stop();
  PublisherQos publisher_qos;
  set_partitions(publisher_qos.partition(), by_hub_if_needed(domain, spec));
  publisher_ = domain.participant().create_publisher(publisher_qos);
  if (publisher_ == nullptr) {
    throw_not_created("publisher", spec);
  }
  DataWriterQos qos = domain.profiles().writer(*publisher_, profile_of(spec, "_writer"));
  if (spec.region) {
    qos.user_data().setValue(user_data_of(*spec.region));
  }
  const bool needs_room = !spec.is_of_hub || spec.topic == TopicId::kCheckpoint;
  if (part_fields_ != nullptr && needs_room) make_room_for_parts(qos, domain);
  be_patient(qos.reliable_writer_qos().times.heartbeatPeriod, shortest_heartbeat(spec.topic, domain.nodes()));
  if (spec.is_of_hub) fit_to_hub(qos, spec.topic, domain.nodes());
  writer_ = publisher_->create_datawriter(&topic, qos, &watch_, StatusMask::publication_matched());
  if (writer_ == nullptr) {
    throw_not_created("writer", spec);
  }
  if (is_of_nodes_) domain.guard().add_writer_of_nodes(entity_of(writer_->guid()), spec.topic == TopicId::kAura);
  if (spec.region) {
    domain.directory().add(writer_->guid(), *spec.region);
  }
  domain.speakers().add(writer_->guid(), spec.partitions);  // own readers may hear it
  if (qos.liveliness().kind == eprosima::fastdds::dds::MANUAL_BY_TOPIC_LIVELINESS_QOS) {
    const bool is_sparse = is_renewed_sparsely(domain.nodes(), domain.believes_silence());
    domain.liveliness().add(writer_, std::chrono::nanoseconds(qos.liveliness().lease_duration.to_ns()),
                            is_sparse ? &written_ns_ : nullptr);
  }
}

Writer::~Writer() {
  domain_.speakers().remove(writer_->guid());
  if (is_of_nodes_) domain_.guard().remove_writer_of_nodes(entity_of(writer_->guid()));
  domain_.liveliness().remove(writer_);
  // With samples in its history a writer can lock up as it is deleted: a heartbeat that is being sent just then looks
  // for holes in the history for ever (Fast DDS 2.9.1, StatefulWriter::add_gaps_for_holes_in_history_).
  forget_all();
  const auto stopped = domain_.guard().delivery().stop();
  writer_->set_listener(nullptr);
  publisher_->delete_datawriter(writer_);
  domain_.participant().delete_publisher(publisher_);
}

WriteResult Writer::write(void* sample) {
  if (part_fields_ == nullptr) return write_sample(sample);
  part_fields_->clear(sample);
  const std::uint32_t message_B = type_->getSerializedSizeProvider(sample)();
  return message_B <= largest_sample_B() ? write_sample(sample) : write_parts(sample, message_B);
}

std::uint32_t Writer::largest_sample_B() const {
  std::size_t headers_B = kHeaders_B;
  std::size_t readers = watch_.readers().size();
  if (goes_by_hub_) {
    headers_B += kOriginal_B;
    readers = std::max(readers, domain_.nodes() + kReadersBesideNodes);  // the hub's, to whom it passes the sample on
  }
  if (domain_.has_keys()) headers_B += kCryptoHeaders_B + kCryptoOfAReader_B * readers;
  const std::uint32_t least_B = least_sample_B(domain_);
  return std::max(least_B,
                  domain_.datagram_B() - std::min(static_cast<std::uint32_t>(headers_B), domain_.datagram_B()));
}

/// Writes the parts of a message. After a failure the readers drop those before it.
WriteResult Writer::write_parts(void* message, std::uint32_t message_B) {
  if (message_B > messages::kLargestMessage_B) return WriteResult::kFailed;
  SerializedPayload_t whole(message_B);
  if (!type_->serialize(message, &whole)) return WriteResult::kFailed;
  if (part_ == nullptr) part_ = part_fields_->make_sample();
  const std::span<const std::uint8_t> octets(whole.data, whole.length);
  const std::uint32_t part_B = largest_sample_B() - part_fields_->empty_B();
  ++messages_in_parts_;
  WriteResult result = WriteResult::kSent;
  for (std::uint32_t i = 0; i < messages::parts_of(octets.size(), part_B); ++i) {
    part_fields_->put(message, messages::part_of(octets, messages_in_parts_, i, part_B), part_.get());
    const WriteResult written = write_sample(part_.get());
    if (written == WriteResult::kFailed) return written;
    if (written != WriteResult::kSent) result = written;
  }
  return result;
}

/// Writes a sample, a second time if need be.
WriteResult Writer::write_in_two_tries(void* sample, eprosima::fastrtps::rtps::WriteParams& params) {
  const std::lock_guard alone(writing_);
  const auto write = [&] {
    params.source_timestamp().from_ns(sent_.next(core::wall_clock_ns()));
    return writer_->write(sample, params);
  };
  WriteResult result = WriteResult::kSent;
  if (!write()) {
    result = WriteResult::kSentAtSecondTry;
    if (!write()) return WriteResult::kFailed;
  }
  written_ns_.store(LivelinessAsserter::now_ns(), std::memory_order_relaxed);
  return result;
}

WriteResult Writer::write_sample(void* sample) {
  eprosima::fastrtps::rtps::WriteParams params;
  return write_in_two_tries(sample, params);
}

WriteResult Writer::pass_on(const PassedSample& passed) {
  eprosima::fastrtps::rtps::WriteParams params;
  params.related_sample_identity().writer_guid(passed.writer);
  params.related_sample_identity().sequence_number(
      eprosima::fastrtps::rtps::SequenceNumber_t(static_cast<std::uint64_t>(passed.number)));
  return write_in_two_tries(passed.sample.get(), params);
}

void Writer::forget_all() {
  std::size_t forgotten = 0;
  writer_->clear_history(&forgotten);
}

bool Writer::all_acknowledged() { return writer_->wait_for_acknowledgments({0, 0}) == ReturnCode_t::RETCODE_OK; }

std::size_t Writer::forget_acknowledged() {
  std::size_t forgotten = 0;
  if (all_acknowledged()) {
    writer_->clear_history(&forgotten);
    unread_ = 0;
  } else if (const auto& history = writer_->get_qos().history();
             ++unread_ == history.depth && history.kind == eprosima::fastdds::dds::KEEP_LAST_HISTORY_QOS) {
    say_who_does_not_read();
  }
  return forgotten;
}

/// Logs which reader does not acknowledge. Fast DDS 2.9 does not report which reader a writer waits for.
void Writer::say_who_does_not_read() {
  std::set<std::string> strangers;
  for (const Guid& reader : watch_.readers()) {
    if (!domain_.speakers().is_node(reader)) strangers.insert(text_of(reader.guidPrefix));
  }
  domain_.speakers().say(
      fmt::format("a reader of topic {} has acknowledged none of {} samples: older ones are dropped. Readers of "
                  "processes that are no nodes: [{}]",
                  writer_->get_topic()->get_name(), unread_, fmt::join(strangers, ", ")));
}

bool Writer::reaches(core::RegionId region) const {
  return std::ranges::any_of(watch_.readers(), [&](const Guid& reader) {
    return domain_.directory().region_of(reader) == std::int64_t{core::value_of(region)} &&
           domain_.speakers().may_speak(reader, region);
  });
}

std::size_t Writer::foreign_reader_count() const {
  const auto readers = watch_.readers();
  return static_cast<std::size_t>(std::ranges::count_if(
      readers, [&](const Guid& reader) { return reader.guidPrefix != writer_->guid().guidPrefix; }));
}

Reader::Reader(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup, std::function<void()> on_data)
    : domain_(domain),
      type_(domain.participant().find_type(domain.topic(spec.topic).get_type_name())),
      part_fields_(part_fields_of(type_)),
      wakeup_(wakeup),
      is_from_hub_(spec.is_from_hub),
      spec_from_hub_(spec_from_hub(spec)),
      watch_(wakeup, [&speakers = domain.speakers()](const Guid& writer) { return speakers.home_of(writer); }) {
  watch_.tell_data(std::move(on_data));
  look_for_hub();
  if (spec.is_from_hub) {
    watch_.tell_matches([&speakers = domain.speakers()](const Guid& hub, bool is_there) {
      is_there ? speakers.add_hub(hub.guidPrefix) : speakers.remove_hub(hub.guidPrefix);
    });
  }
  auto& topic = domain.topic(spec.topic);
  const auto stopped = domain.guard().delivery().stop();
  SubscriberQos subscriber_qos;
  set_partitions(subscriber_qos.partition(), spec.partitions);
  subscriber_ = domain.participant().create_subscriber(subscriber_qos);
  if (subscriber_ == nullptr) {
    throw_not_created("subscriber", spec);
  }
  DataReaderQos qos = domain.profiles().reader(*subscriber_, profile_of(spec, "_reader"));
  if (spec.region) {
    qos.user_data().setValue(user_data_of(*spec.region));
  }
  if (part_fields_ != nullptr && keeps_last(qos.history())) {
    qos.history().depth = qos.resource_limits().max_samples_per_instance = depth_of(qos.history(), domain);
  }
  // No limits, whatever a profile says (guarded_type.h). If one of the two is unlimited, the other must be, too.
  qos.resource_limits().max_instances = qos.resource_limits().max_samples = 0;
  if (spec.best_effort_if_volatile && qos.durability().kind == eprosima::fastdds::dds::VOLATILE_DURABILITY_QOS) {
    qos.reliability().kind = eprosima::fastdds::dds::BEST_EFFORT_RELIABILITY_QOS;
  }
  be_patient(qos.reliable_reader_qos().times.initialAcknackDelay, shortest_heartbeat(spec.topic, domain.nodes()));
  if (qos.liveliness().kind == eprosima::fastdds::dds::MANUAL_BY_TOPIC_LIVELINESS_QOS) {
    if (is_renewed_sparsely(domain.nodes(), domain.believes_silence()))
      be_patient(qos.liveliness().lease_duration, kSparseLease);
    const std::chrono::nanoseconds lease(qos.liveliness().lease_duration.to_ns());
    believed_silence_ = lease + lease / 2;
    watch_.set_grace(domain.believes_silence() ? lease / 2 : ReaderWatch::kForEver);
  }
  reader_ = subscriber_->create_datareader(
      &topic, qos, &watch_,
      StatusMask::data_available() << StatusMask::subscription_matched() << StatusMask::liveliness_changed());
  if (reader_ == nullptr) {
    throw_not_created("reader", spec);
  }
  if (spec.region) {
    domain.directory().add(reader_->guid(), *spec.region);
  }
}

std::vector<RemoteWriter> Reader::writers() const {
  std::vector<RemoteWriter> writers = watch_.writers();
  if (from_hub_ != nullptr) std::ranges::copy(from_hub_->writers(), std::back_inserter(writers));
  return writers;
}

/// Reads what a hub passes on, once this process has to, in a run with keys.
void Reader::look_for_hub() {
  if (!spec_from_hub_ || !domain_.reads_from_hub()) return;
  const EndpointSpec spec = *std::exchange(spec_from_hub_, std::nullopt);
  try {
    from_hub_ = std::make_unique<Reader>(domain_, spec, wakeup_);
  } catch (const DdsError& error) {
    if (domain_.speaks_by_hub()) throw;
    domain_.speakers().say(fmt::format("a process says that it is a hub, and is not heard: {}", error.what()));
  }
}

Reader::~Reader() {
  const auto stopped = domain_.guard().delivery().stop();
  reader_->set_listener(nullptr);
  subscriber_->delete_datareader(reader_);
  domain_.participant().delete_subscriber(subscriber_);
}

bool Reader::take(void* sample, Origin* origin) {
  look_for_hub();
  return (from_hub_ != nullptr && from_hub_->take_own(sample, origin)) || take_own(sample, origin);
}

std::uint64_t Reader::take_lost() {
  return std::exchange(lost_, 0) + (from_hub_ == nullptr ? 0 : from_hub_->take_lost());
}

/// Takes the next message of this DDS reader alone.
bool Reader::take_own(void* sample, Origin* origin) {
  SampleInfo info;
  while (reader_->take_next_sample(sample, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    Guid writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
    const bool by_hub = domain_.has_keys() ? is_from_hub_ : domain_.speakers().is_hub(writer.guidPrefix);
    if (by_hub) {
      const auto& origin_of = info.related_sample_identity;
      writer = origin_of.writer_guid();
      if (!by_hub_.is_news(writer, static_cast<std::int64_t>(origin_of.sequence_number().to64long()))) continue;
    }
    if (domain_.speakers().shuns(writer.guidPrefix)) continue;
    if (origin != nullptr) {
      origin->writer = writer;
      origin->by_hub = by_hub;
      origin->received_ns = info.reception_timestamp.to_ns();
      origin->clock_ahead = std::chrono::nanoseconds(info.source_timestamp.to_ns() - origin->received_ns);
    }
    const auto part = part_fields_ == nullptr ? std::nullopt : part_fields_->get(sample);
    if (!part || put_together(sample, *part, writer)) return true;
  }
  return false;
}

bool Reader::take_sample(PassedSample& taken) {
  SampleInfo info;
  while (reader_->take_next_sample(taken.sample.get(), &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    taken.writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
    taken.number = static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long());
    std::copy_n(&info.instance_handle.value[0], taken.key.size(), taken.key.begin());
    return true;
  }
  return false;
}

std::shared_ptr<void> Reader::make_sample() {
  return {type_->createData(), [type = type_](void* sample) mutable { type->deleteData(sample); }};
}

/// Adds a part. True when its message is whole: then `sample` is the message.
bool Reader::put_together(void* sample, const messages::Part& part, const Guid& writer) {
  messages::PartAssembly::Stream stream;
  std::ranges::copy(prefix_of(writer.guidPrefix), stream.process.begin());
  stream.endpoints = std::uint64_t{entity_of(reader_->guid())} << 32 | entity_of(writer);
  auto added = domain_.parts().add(stream, part, std::chrono::steady_clock::now().time_since_epoch());
  lost_ += added.lost;
  if (!added.whole) return false;
  SerializedPayload_t payload;
  payload.data = added.whole->data();
  payload.length = payload.max_size = static_cast<std::uint32_t>(added.whole->size());
  type_->deserialize(&payload, sample);
  payload.data = nullptr;  // or its destructor would free it
  return true;
}

void Reader::refuse_from(const Origin& origin, messages::WireError error) {
  const bool is_no_message = error == messages::WireError::kMalformed || error == messages::WireError::kLength ||
                             error == messages::WireError::kTooLarge || error == messages::WireError::kEnum;
  if (!is_no_message) return;
  refuse_from(origin, fmt::format("it sends invalid data ({})", name_of(error)));
}

void Reader::refuse_from(const Origin& origin, const std::string& what) {
  domain_.speakers().refuse(origin.writer, fmt::format("{}: {}", reader_->get_topicdescription()->get_name(), what));
}

void Reader::ration(const Origin& origin, const std::string& what) {
  domain_.speakers().ration(origin.writer, fmt::format("{}: {}", reader_->get_topicdescription()->get_name(), what));
}

std::vector<std::string> Reader::partitions() const { return subscriber_->get_qos().partition().names(); }

}  // namespace aurasim::dds
