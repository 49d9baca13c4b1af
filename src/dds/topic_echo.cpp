#include "dds/topic_echo.h"

#include <map>
#include <stdexcept>

#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastrtps/types/DynamicData.h>
#include <fastrtps/types/DynamicDataFactory.h>
#include <fastrtps/types/DynamicPubSubType.h>
#include <fastrtps/types/DynamicType.h>
#include <fastrtps/types/DynamicTypeMember.h>
#include <fastrtps/types/MemberDescriptor.h>
#include <fastrtps/types/TypeObjectFactory.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dds/endpoints.h"

namespace aurasim::dds {

namespace types = eprosima::fastrtps::types;
using eprosima::fastdds::dds::TypeSupport;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using Json = nlohmann::ordered_json;

namespace {

std::optional<TopicId> topic_named(const std::string& name) {
  for (std::size_t i = 0; i < kTopicCount; ++i) {
    if (name_of(static_cast<TopicId>(i)) == name) return static_cast<TopicId>(i);
  }
  return std::nullopt;
}

types::DynamicType_ptr dynamic_type(const std::string& name) {
  auto* factory = types::TypeObjectFactory::get_instance();
  const auto* identifier = factory->get_type_identifier(name, true);
  const auto* object = factory->get_type_object(name, true);
  if (identifier == nullptr || object == nullptr) throw DdsError(fmt::format("the type {} has no TypeObject", name));
  return factory->build_dynamic_type(name, identifier, object);
}

Json to_json(types::DynamicData& data, types::MemberId id, types::DynamicType& type);

Json sequence_to_json(types::DynamicData& data, types::MemberId id, types::DynamicType& type) {
  Json list = Json::array();
  types::DynamicData* values = data.loan_value(id);
  const types::DynamicType_ptr element = type.get_descriptor()->get_element_type();
  for (std::uint32_t i = 0; i < values->get_item_count(); ++i) list.push_back(to_json(*values, i, *element));
  data.return_loaned_value(values);
  return list;
}

/// Converts one member. Supports the kinds that occur in idl/: primitives, strings and sequences of them.
Json to_json(types::DynamicData& data, types::MemberId id, types::DynamicType& type) {
  switch (type.get_kind()) {
    case types::TK_BOOLEAN:
      return data.get_bool_value(id);
    case types::TK_BYTE:
      return data.get_byte_value(id);
    case types::TK_INT32:
      return data.get_int32_value(id);
    case types::TK_INT64:
      return data.get_int64_value(id);
    case types::TK_UINT16:
      return data.get_uint16_value(id);
    case types::TK_UINT32:
      return data.get_uint32_value(id);
    case types::TK_UINT64:
      return data.get_uint64_value(id);
    case types::TK_FLOAT32:
      return data.get_float32_value(id);
    case types::TK_FLOAT64:
      return data.get_float64_value(id);
    case types::TK_STRING8:
      return data.get_string_value(id);
    case types::TK_SEQUENCE:
      return sequence_to_json(data, id, type);
    default:
      throw std::logic_error(fmt::format("no JSON for type kind {:#x}", type.get_kind()));
  }
}

/// Spec of a reader that only watches. It must hold up no writer, so where no history is asked for a lost sample stays
/// lost.
EndpointSpec watching(TopicId topic, const std::string& partition) {
  EndpointSpec spec{topic, {partition}, {}, {}};
  const bool has_lives = topic == TopicId::kAura || topic == TopicId::kMigration || topic == TopicId::kMigrationAck;
  if (has_lives) spec.partitions.push_back(in_any_life(partition));
  spec.best_effort_if_volatile = true;
  return spec;
}

TopicId checked(const std::string& name) {
  const std::optional<TopicId> topic = topic_named(name);
  if (!topic)
    throw std::invalid_argument(fmt::format("no topic '{}'; there are {}", name, fmt::join(topic_names(), ", ")));
  return *topic;
}

}  // namespace

std::vector<std::string> topic_names() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kTopicCount; ++i) names.emplace_back(name_of(static_cast<TopicId>(i)));
  return names;
}

std::vector<std::string> partitions_of_topic(const std::string& name, std::size_t regions) {
  std::vector<std::string> partitions;
  const auto each_region = [&](const auto& add) {
    for (std::uint32_t r = 0; r < regions; ++r) add(core::RegionId{r});
  };
  switch (checked(name)) {
    case TopicId::kAura:
    case TopicId::kNodeStatus:
    case TopicId::kReplica:
    case TopicId::kReplicaKey:
    case TopicId::kClusterGraph:
      each_region([&](core::RegionId source) { partitions.push_back(partition_of(source)); });
      break;
    case TopicId::kObservation:  // observations of all observers
      each_region([&](core::RegionId source) { partitions.push_back(partition_of(source) + "/observer/*"); });
      break;
    case TopicId::kMigration:
    case TopicId::kMigrationAck:
    case TopicId::kCheckpoint:
      each_region([&](core::RegionId source) {
        each_region([&](core::RegionId destination) { partitions.push_back(partition_of(source, destination)); });
      });
      break;
    default:
      partitions.push_back(kWorldPartition);
  }
  return partitions;
}

std::string every_partition_of_topic(const std::string& name) {
  const std::vector<std::string> partitions = partitions_of_topic(name, 1);
  if (checked(name) == TopicId::kCheckpoint) return "*";  // includes the parts that are sent to all
  return partitions.front() == kWorldPartition ? kWorldPartition : kEveryRegionPartition;
}

struct TopicEcho::Impl {
  Impl(Participant& participant_in, TopicId topic, const std::string& partition)
      : participant(participant_in),
        reader(participant.domain(), watching(topic, partition), wakeup),
        type(participant.domain().participant().find_type(participant.domain().topic(topic).get_type_name())),
        sample(type.create_data()),
        dynamic(dynamic_type(type.get_type_name())),
        dynamic_support(dynamic) {
    std::map<types::MemberId, types::DynamicTypeMember*> by_id;
    dynamic->get_all_members(by_id);
    for (const auto& [id, member] : by_id) members.push_back(member);
  }
  ~Impl() { type.delete_data(sample); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Converts through the serialized bytes, which both types share.
  Json sample_as_json() {
    SerializedPayload_t payload(type->getSerializedSizeProvider(sample)());
    type.serialize(sample, &payload);
    types::DynamicData_ptr data(types::DynamicDataFactory::get_instance()->create_data(dynamic));
    dynamic_support.deserialize(&payload, data.get());
    Json object = Json::object();
    for (types::DynamicTypeMember* member : members) {
      object[member->get_name()] = to_json(*data, member->get_id(), *member->get_descriptor()->get_type());
    }
    return object;
  }

  Participant& participant;
  Wakeup wakeup;
  Reader reader;
  TypeSupport type;
  void* sample;  ///< one sample of the generated type
  types::DynamicType_ptr dynamic;
  types::DynamicPubSubType dynamic_support;
  std::vector<types::DynamicTypeMember*> members;  ///< in the order of the IDL
};

TopicEcho::TopicEcho(Participant& participant, const std::string& topic, const std::string& partition)
    : impl_(std::make_unique<Impl>(participant, checked(topic), partition)) {}

TopicEcho::~TopicEcho() = default;

std::optional<Json> TopicEcho::take() {
  impl_->participant.progress();
  impl_->wakeup.clear();
  if (!impl_->reader.take(impl_->sample)) return std::nullopt;
  return impl_->sample_as_json();
}

void TopicEcho::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

}  // namespace aurasim::dds
