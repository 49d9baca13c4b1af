#include "dds/endpoints.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dds/datagram_guard.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DataReaderQos;
using eprosima::fastdds::dds::DataWriterQos;
using eprosima::fastdds::dds::HANDLE_NIL;
using eprosima::fastdds::dds::PublisherQos;
using eprosima::fastdds::dds::SampleInfo;
using eprosima::fastdds::dds::StatusMask;
using eprosima::fastdds::dds::SubscriberQos;
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

bool is_of_nodes(TopicId topic) {
  return topic == TopicId::kAura || topic == TopicId::kMigration || topic == TopicId::kMigrationAck;
}

/// Entity id as one number, in the form in which the guard reads it from the wire.
std::uint32_t entity_of(const Guid& endpoint) {
  std::uint32_t entity = 0;
  for (const unsigned char octet : endpoint.entityId.value) entity = entity << 8 | octet;
  return entity;
}

[[noreturn]] void throw_not_created(const char* what, const EndpointSpec& spec) {
  throw DdsError(fmt::format("cannot create the {} of topic {} in partition {} (Fast DDS says more on standard error)",
                             what, name_of(spec.topic), fmt::join(spec.partitions, ", ")));
}

}  // namespace

Writer::Writer(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup)
    : domain_(domain), watch_(wakeup), is_of_nodes_(is_of_nodes(spec.topic)) {
  auto& topic = domain.topic(spec.topic);
  const auto stopped = domain.guard().delivery().stop();
  PublisherQos publisher_qos;
  set_partitions(publisher_qos.partition(), spec.partitions);
  publisher_ = domain.participant().create_publisher(publisher_qos);
  if (publisher_ == nullptr) {
    throw_not_created("publisher", spec);
  }
  DataWriterQos qos = domain.profiles().writer(*publisher_, profile_of(spec, "_writer"));
  if (spec.region) {
    qos.user_data().setValue(user_data_of(*spec.region));
  }
  writer_ = publisher_->create_datawriter(&topic, qos, &watch_, StatusMask::publication_matched());
  if (writer_ == nullptr) {
    throw_not_created("writer", spec);
  }
  if (is_of_nodes_) domain.guard().add_writer_of_nodes(entity_of(writer_->guid()));
  if (spec.region) {
    domain.directory().add(writer_->guid(), *spec.region);
  }
  if (qos.liveliness().kind == eprosima::fastdds::dds::MANUAL_BY_TOPIC_LIVELINESS_QOS) {
    domain.liveliness().add(writer_, std::chrono::nanoseconds(qos.liveliness().lease_duration.to_ns()));
  }
}

Writer::~Writer() {
  if (is_of_nodes_) domain_.guard().remove_writer_of_nodes(entity_of(writer_->guid()));
  domain_.liveliness().remove(writer_);
  const auto stopped = domain_.guard().delivery().stop();
  writer_->set_listener(nullptr);
  publisher_->delete_datawriter(writer_);
  domain_.participant().delete_publisher(publisher_);
}

WriteResult Writer::write(void* sample) {
  if (writer_->write(sample, HANDLE_NIL) == ReturnCode_t::RETCODE_OK) {
    return WriteResult::kSent;
  }
  const bool sent = writer_->write(sample, HANDLE_NIL) == ReturnCode_t::RETCODE_OK;
  return sent ? WriteResult::kSentAtSecondTry : WriteResult::kFailed;
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
  domain_.speakers().say(fmt::format(
      "somebody listens to {} and has acknowledged nothing of {} samples: older ones are dropped. Readers of "
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

Reader::Reader(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup) : domain_(domain), watch_(wakeup) {
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
  // No limits, whatever a profile says (guarded_type.h). If one of the two is unlimited, the other must be, too.
  qos.resource_limits().max_instances = qos.resource_limits().max_samples = 0;
  if (spec.best_effort_if_volatile && qos.durability().kind == eprosima::fastdds::dds::VOLATILE_DURABILITY_QOS) {
    qos.reliability().kind = eprosima::fastdds::dds::BEST_EFFORT_RELIABILITY_QOS;
  }
  if (qos.liveliness().kind == eprosima::fastdds::dds::MANUAL_BY_TOPIC_LIVELINESS_QOS) {
    const std::chrono::nanoseconds lease(qos.liveliness().lease_duration.to_ns());
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

Reader::~Reader() {
  const auto stopped = domain_.guard().delivery().stop();
  reader_->set_listener(nullptr);
  subscriber_->delete_datareader(reader_);
  domain_.participant().delete_subscriber(subscriber_);
}

bool Reader::take(void* sample, Origin* origin) {
  SampleInfo info;
  while (reader_->take_next_sample(sample, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    const Guid writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
    if (domain_.speakers().shuns(writer.guidPrefix)) continue;
    if (origin != nullptr) {
      origin->writer = writer;
      origin->clock_ahead = std::chrono::nanoseconds(info.source_timestamp.to_ns() - info.reception_timestamp.to_ns());
    }
    return true;
  }
  return false;
}

void Reader::refuse_from(const Origin& origin, WireError error) {
  const bool is_no_message = error == WireError::kMalformed || error == WireError::kLength ||
                             error == WireError::kTooLarge || error == WireError::kEnum;
  if (!is_no_message) return;
  refuse_from(origin, fmt::format("it sends what cannot be ({})", name_of(error)));
}

void Reader::refuse_from(const Origin& origin, const std::string& what) {
  domain_.speakers().refuse(origin.writer, fmt::format("{}: {}", reader_->get_topicdescription()->get_name(), what));
}

void Reader::ration(const Origin& origin, const std::string& what) {
  domain_.speakers().ration(origin.writer, fmt::format("{}: {}", reader_->get_topicdescription()->get_name(), what));
}

std::vector<std::string> Reader::partitions() const { return subscriber_->get_qos().partition().names(); }

}  // namespace aurasim::dds
