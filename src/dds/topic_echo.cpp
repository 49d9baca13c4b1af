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
  if (topics::at(topic).by_life) spec.partitions.push_back(topics::in_later_lives(partition));
  spec.best_effort_if_volatile = true;
  return spec;
}

}  // namespace

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

TopicEcho::TopicEcho(Participant& participant, TopicId topic, const std::string& partition)
    : impl_(std::make_unique<Impl>(participant, topic, partition)) {}

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
