// Keeps track of which other participants of a domain use keys. In every run a participant announces itself in the
// clear, and one with keys names its identity there (DDS Security 1.1, section 7.4.1.2). So a process with no keys, or
// with other keys, still learns that it is there.
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
  /// Takes note that `participant` could not prove its identity.
  void note_refused(const eprosima::fastrtps::rtps::GUID_t& participant);
  PeersByKeys count() const;

 private:
  using Prefixes = std::set<eprosima::fastrtps::rtps::GuidPrefix_t>;

  mutable std::mutex mutex_;
  Prefixes with_keys_, without_keys_, refused_;
};

}  // namespace aurasim::dds
