#include "dds/domain.h"

#include <algorithm>
#include <utility>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>

#include "aurasimPubSubTypes.h"
#include "dds/impairment_properties.h"
#include "dds/many_nodes.h"
#include "dds/participant_qos.h"
#include "dds/wire_transport.h"
#include "messages/guarded_type.h"
#include "messages/type_tables.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DomainParticipantFactory;
using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::dds::StatusMask;
using eprosima::fastdds::dds::TypeSupport;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

/// Lease of a process whose silence is not believed. It is long, so that DDS does not drop a slow process, which would
/// have to be discovered anew and would lose what was sent meanwhile. Deaths are reported by other means long before.
constexpr std::chrono::seconds kPatientLease{30};

void be_patient_with_this(DomainParticipantQos& qos) {
  auto& lease = qos.wire_protocol().builtin.discovery_config.leaseDuration;
  if (std::chrono::nanoseconds(lease.to_ns()) >= kPatientLease) return;
  lease = eprosima::fastrtps::Duration_t(static_cast<std::int32_t>(kPatientLease.count()), 0);
}

void announce_less(DomainParticipantQos& qos, std::chrono::nanoseconds shortest) {
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  const std::chrono::nanoseconds lease(discovery.leaseDuration.to_ns());
  const std::chrono::nanoseconds period = std::min(shortest, lease / 4);
  if (period.count() <= discovery.leaseDuration_announcementperiod.to_ns()) return;
  discovery.leaseDuration_announcementperiod =
      eprosima::fastrtps::Duration_t(std::chrono::duration<double>(period).count());
}

/// Switches Fast DDS's intraprocess delivery off, so that regions in one process communicate over the wire like regions
/// in two.
void switch_intraprocess_delivery_off() {
  eprosima::fastrtps::LibrarySettingsAttributes library;
  library.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
}

MeetingPoint meeting_point(const eprosima::fastrtps::rtps::Locator_t& locator) {
  const auto* const octets = eprosima::fastrtps::rtps::IPLocator::getIPv4(locator);
  MeetingPoint point;
  for (int i = 0; i < 4; ++i) point.address = point.address << 8 | octets[i];
  point.port = static_cast<std::uint16_t>(locator.port);
  return point;
}

rtps::WireGuid wire_guid(const Guid& endpoint) {
  rtps::WireGuid guid{prefix_of(endpoint.guidPrefix)};
  for (const unsigned char octet : endpoint.entityId.value) guid.entity = guid.entity << 8 | octet;
  return guid;
}

template <class Generated>
TypeSupport guarded(bool announces) {
  return TypeSupport(new messages::GuardedType<Generated>(announces));
}

}  // namespace

Domain::Domain(const Settings& settings)
    : profiles_(settings.profiles),
      guard_(std::make_shared<rtps::DatagramGuard>()),
      speakers_(guard_),
      nodes_(settings.nodes),
      speaks_by_hub_(settings.discovery == config::Discovery::kNeighbours && settings.introductions == nullptr),
      introductions_(settings.introductions) {
  DomainParticipantQos qos = participant_qos(profiles_, settings);
  datagram_B_ = largest_datagram_B(qos);
  has_keys_ = settings.keys.has_value();
  if (has_keys_) make_room_for_handshakes(qos);
  loopback_only_ = on_loopback_only(qos);
  hears_hubs_ = speaks_by_hub_ || (settings.discovery == config::Discovery::kAuto && loopback_only_);
  believes_silence_ = settings.believes_silence || !loopback_only_;
  if (!believes_silence_) be_patient_with_this(qos);
  // A discovery server has to be asked again until it answers.
  const bool finds_all_itself = settings.discovery != config::Discovery::kServer;
  if (finds_all_itself) announce_less(qos, shortest_announcement_period(settings.nodes));
  const Impairment impairment = settings.impairment.over(impairment_in(qos.properties(), profiles_.file().string()));
  if (impairment.any()) {
    delay_line_ =
        std::make_shared<DelayLine>(impairment, settings.impairment_stream, metatraffic_ports(qos, settings.domain));
  }
  install(qos,
          {guard_, delay_line_, shortest_between_announcements(finds_all_itself ? settings.nodes : 1), introductions_});
  switch_intraprocess_delivery_off();
  messages::set_type_tables_up();
  if (settings.keys) refusals_.emplace(settings.report_refusal);
  const auto closed = guard_->delivery().close();
  participant_.reset(
      DomainParticipantFactory::get_instance()->create_participant(settings.domain, qos, this, StatusMask::none()));
  if (participant_ == nullptr) {
    throw DdsError(fmt::format(
        "cannot join DDS domain {} with the profiles of {} (Fast DDS says more on standard error); are the interfaces "
        "there, and are fewer than 100 processes in this domain on this host?",
        settings.domain, settings.profiles.string()));
  }
  guard_->set_own(prefix_of(participant_->guid().guidPrefix));
  speakers_.set_self(participant_->guid().guidPrefix);
  register_types(settings.announces_types);
  liveliness_ = std::make_unique<LivelinessAsserter>(settings.hang_limit, settings.show_life);
}

Domain::~Domain() = default;

void Domain::Leave::operator()(eprosima::fastdds::dds::DomainParticipant* participant) const {
  participant->set_listener(nullptr);
  participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant);
}

void Domain::register_types(bool announces) {
  const std::array types = {
      guarded<wire::AuraBatchPubSubType>(announces),   guarded<wire::MigrationPubSubType>(announces),
      guarded<wire::NodeStatusPubSubType>(announces),  guarded<wire::RegionMapPubSubType>(announces),
      guarded<wire::RunControlPubSubType>(announces),  guarded<wire::ReplicaPubSubType>(announces),
      guarded<wire::CommandPubSubType>(announces),     guarded<wire::CommandReplyPubSubType>(announces),
      guarded<wire::MeshShapePubSubType>(announces),   guarded<wire::ClusterGraphPubSubType>(announces),
      guarded<wire::CheckpointPubSubType>(announces),  guarded<wire::SeamPiecePubSubType>(announces),
      guarded<wire::SetpointsPubSubType>(announces),   guarded<wire::InterestPubSubType>(announces),
      guarded<wire::ObservationPubSubType>(announces),
  };
  for (const TypeSupport& type : types) {
    if (type.register_type(participant_.get()) != ReturnCode_t::RETCODE_OK) {
      throw DdsError(fmt::format("cannot register the type {}", type.get_type_name()));
    }
  }
}

eprosima::fastdds::dds::Topic& Domain::topic(TopicId id) {
  const std::lock_guard lock(topics_mutex_);
  const auto index = static_cast<std::size_t>(id);
  if (topics_[index] == nullptr) {
    const topics::Topic& row = topics::at(id);
    topics_[index] = participant_->create_topic(row.name, row.type, eprosima::fastdds::dds::TOPIC_QOS_DEFAULT);
    if (topics_[index] == nullptr) throw DdsError(fmt::format("cannot create the topic {}", row.name));
  }
  return *topics_[index];
}

void Domain::on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                      eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) {
  peer_keys_.note(info);
  using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
  const ProcessPrefix& process = info.info.m_guid.guidPrefix;
  const bool is_gone = info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT;
  const auto& data = info.info.m_userData;
  if (hears_hubs_ && std::ranges::equal(data, kHubUserData)) {
    note_hub(process, is_gone);
  }
  if (introductions_ != nullptr) {
    const auto& points = info.info.metatraffic_locators.unicast;
    is_gone ? introductions_->remove(prefix_of(process))
            : introductions_->add(prefix_of(process), points.empty() ? MeetingPoint() : meeting_point(points[0]));
    wakeup_.notify();
  }
  if (refusals_) SecurityLog::instance().note(info);
}

/// With keys anybody's announcement may say so. It only lets the readers look for a hub: what shows it is its
/// partition.
void Domain::note_hub(const ProcessPrefix& process, bool is_gone) {
  if (has_keys_) {
    hub_is_announced_ = true;
  } else {
    is_gone ? speakers_.remove_hub(process) : speakers_.add_hub(process);
  }
  wakeup_.notify();
}

void Domain::onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant*,
                                         eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) {
  using eprosima::fastrtps::rtps::ParticipantAuthenticationInfo;
  if (info.status != ParticipantAuthenticationInfo::UNAUTHORIZED_PARTICIPANT) return;
  peer_keys_.note_refused(info.guid);
  SecurityLog::instance().refused(info.guid);
}

void Domain::introduce(const rtps::WireGuid& endpoint, bool is_writer, std::string topic,
                       std::vector<std::string> partitions) {
  if (introductions_ == nullptr) return;
  introductions_->add({endpoint, is_writer, std::move(topic), std::move(partitions)});
  wakeup_.notify();
}

void Domain::on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                    eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) {
  using Info = eprosima::fastrtps::rtps::WriterDiscoveryInfo;
  if (info.status == Info::REMOVED_WRITER) {
    directory_.remove(info.info.guid());
    if (introductions_ != nullptr) introductions_->remove(wire_guid(info.info.guid()));
    return speakers_.remove(info.info.guid());
  }
  speakers_.add(info.info.guid(), info.info.m_qos.m_partition.names());
  introduce(wire_guid(info.info.guid()), true, info.info.topicName().c_str(), info.info.m_qos.m_partition.names());
  const auto& data = info.info.m_qos.m_userData;
  if (const auto region = region_in({data.begin(), data.end()}); region >= 0) {
    directory_.add(info.info.guid(), static_cast<core::RegionId>(region));
  }
}

void Domain::on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                     eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == eprosima::fastrtps::rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    if (introductions_ != nullptr) introductions_->remove(wire_guid(info.info.guid()));
    return directory_.remove(info.info.guid());
  }
  introduce(wire_guid(info.info.guid()), false, info.info.topicName().c_str(), info.info.m_qos.m_partition.names());
  const auto& data = info.info.m_qos.m_userData;
  if (const auto region = region_in({data.begin(), data.end()}); region >= 0) {
    directory_.add(info.info.guid(), static_cast<core::RegionId>(region));
  }
}

}  // namespace aurasim::dds
