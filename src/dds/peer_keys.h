// Which other participants of a domain speak with keys. In every run a participant announces itself in the clear, and
// one with keys names its identity there (DDS Security 1.1, section 7.4.1.2): whoever has no keys, or others, still
// learns that somebody is there.
#pragma once

#include <mutex>
#include <set>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>

#include "dds/peers_by_keys.h"

namespace aurasim::dds {

/// Thread-safe.
class PeerKeys {
 public:
  void note(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// It could not prove who it is.
  void note_refused(const eprosima::fastrtps::rtps::GUID_t& participant);
  PeersByKeys count() const;

 private:
  using Prefixes = std::set<eprosima::fastrtps::rtps::GuidPrefix_t>;

  mutable std::mutex mutex_;
  Prefixes with_keys_, without_keys_, refused_;
};

}  // namespace aurasim::dds
