// Implementation of Participant: the Fast DDS participant, its types and topics, and what all endpoints share.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "dds/delay_line.h"
#include "dds/introductions.h"
#include "dds/liveliness_asserter.h"
#include "dds/peer_keys.h"
#include "dds/profiles.h"
#include "dds/security_log.h"
#include "dds/settings.h"
#include "dds/speakers.h"
#include "dds/watch.h"
#include "messages/parts.h"
#include "topics/topics.h"

namespace aurasim::rtps {
class DatagramGuard;
}

namespace aurasim::dds {

using topics::TopicId;

/// Thread-safe.
class Domain final : private eprosima::fastdds::dds::DomainParticipantListener {
 public:
  explicit Domain(const Settings& settings);
  ~Domain() override;
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  eprosima::fastdds::dds::DomainParticipant& participant() { return *participant_; }
  /// Returns the topic; creates it at the first call.
  eprosima::fastdds::dds::Topic& topic(TopicId id);
  Profiles& profiles() { return profiles_; }
  Directory& directory() { return directory_; }
  Speakers& speakers() { return speakers_; }
  /// True if messages to all go by a hub.
  bool speaks_by_hub() const { return speaks_by_hub_; }
  /// True if this process reads what a hub passes on in a partition of its own: in a run with keys that has a hub.
  bool reads_from_hub() const { return has_keys_ && hears_hubs_ && (speaks_by_hub_ || hub_is_announced_); }
  /// True if a hub is there, or none is needed.
  bool has_way_to_all() const { return !speaks_by_hub_ || speakers_.has_hub(); }
  /// Which of the other participants use keys.
  const PeerKeys& peer_keys() const { return peer_keys_; }
  /// True when no datagram leaves this host.
  bool loopback_only() const { return loopback_only_; }
  LivelinessAsserter& liveliness() { return *liveliness_; }
  /// Value of Settings::believes_silence; always true when traffic leaves this host, because silence between hosts may
  /// be a cut network.
  bool believes_silence() const { return believes_silence_; }
  /// Wakes the thread that uses this process's endpoints when a sample arrives at any of them: it waits for one of them
  /// and serves all. Endpoints used by another thread have a wakeup of their own.
  Wakeup& wakeup() { return wakeup_; }
  /// The delay line of this participant; null when the network is not impaired.
  DelayLine* delay_line() const { return delay_line_.get(); }
  /// Largest datagram that goes out, bytes, without the headers of IP and UDP.
  std::uint32_t datagram_B() const { return datagram_B_; }
  /// Value of Settings::nodes.
  std::size_t nodes() const { return nodes_; }
  /// True when what is sent is encrypted by keys.
  bool has_keys() const { return has_keys_; }
  /// Puts together the messages that all readers of this process receive in parts.
  messages::PartAssembly& parts() { return parts_; }
  /// The guard that keeps malformed datagrams from Fast DDS.
  rtps::DatagramGuard& guard() const { return *guard_; }

 private:
  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant* participant,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void register_types(bool announces);
  void note_hub(const ProcessPrefix& process, bool is_gone);
  void introduce(const rtps::WireGuid& endpoint, bool is_writer, std::string topic,
                 std::vector<std::string> partitions);

  Wakeup wakeup_;
  Profiles profiles_;
  Directory directory_;
  std::shared_ptr<rtps::DatagramGuard> guard_;
  Speakers speakers_;
  PeerKeys peer_keys_;
  messages::PartAssembly parts_;
  std::size_t nodes_ = 1;
  std::uint32_t datagram_B_ = 0;
  bool has_keys_ = false;
  bool speaks_by_hub_ = false;
  bool hears_hubs_ = false;                       ///< what a hub passes on counts as its source's
  std::atomic<bool> hub_is_announced_{false};     ///< with keys: a process calls itself a hub
  std::shared_ptr<Introductions> introductions_;  ///< only in a hub
  bool loopback_only_ = false;
  bool believes_silence_ = true;
  std::optional<SecurityLog::Hearing> refusals_;  ///< receives refusals by keys; only in a run with keys
  std::shared_ptr<DelayLine> delay_line_;
  std::mutex topics_mutex_;
  std::array<eprosima::fastdds::dds::Topic*, topics::kTopicCount> topics_{};
  struct Leave {
    void operator()(eprosima::fastdds::dds::DomainParticipant* participant) const;
  };
  std::unique_ptr<eprosima::fastdds::dds::DomainParticipant, Leave> participant_;
  std::unique_ptr<LivelinessAsserter> liveliness_;  // last: stops first
};

}  // namespace aurasim::dds
