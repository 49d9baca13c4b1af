#include "dds/peer_keys.h"

namespace aurasim::dds {

void PeerKeys::note(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info) {
  using Info = eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
  const auto& prefix = info.info.m_guid.guidPrefix;
  const std::lock_guard lock(mutex_);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
    for (Prefixes* const prefixes : {&with_keys_, &without_keys_, &refused_}) prefixes->erase(prefix);
  } else {
    (info.info.identity_token_.class_id().empty() ? without_keys_ : with_keys_).insert(prefix);
  }
}

void PeerKeys::note_refused(const eprosima::fastrtps::rtps::GUID_t& participant) {
  const std::lock_guard lock(mutex_);
  if (with_keys_.contains(participant.guidPrefix)) refused_.insert(participant.guidPrefix);
}

PeersByKeys PeerKeys::count() const {
  const std::lock_guard lock(mutex_);
  return {with_keys_.size(), without_keys_.size(), refused_.size()};
}

}  // namespace aurasim::dds
