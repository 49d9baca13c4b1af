// Regions in one process, each with a participant of its own, on loopback.
#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "dds/control.h"
#include "dds/dds_transport.h"
#include "dds/participant.h"
#include "messages/samples.h"
#include "own_domain.h"

namespace aurasim::dds {

using test::own_domain;

}  // namespace aurasim::dds

namespace aurasim::dds::testing {

using namespace std::chrono_literals;

inline constexpr std::uint64_t kMapVersion = 0xfedc'ba98'7654'3210U;  // as in messages.h
inline constexpr std::chrono::seconds kDeadline = 60s;                // for a busy machine; nothing takes that long

template <class Condition>
bool holds_in_time(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kDeadline;
  while (!condition() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

inline Settings settings_for(std::uint32_t domain, const std::string& profiles = "aurasim.xml") {
  Settings settings;
  settings.domain = domain;
  settings.profiles = std::filesystem::path(AURASIM_SOURCE_DIR) / "qos" / profiles;
  return settings;
}

inline std::vector<core::RegionId> regions(std::initializer_list<std::uint32_t> ids) {
  std::vector<core::RegionId> result;
  for (const std::uint32_t id : ids) {
    result.push_back(static_cast<core::RegionId>(id));
  }
  return result;
}

/// One region as a node would have it.
struct Peer {
  Peer(std::uint32_t domain, std::uint32_t region, std::initializer_list<std::uint32_t> neighbours)
      : Peer(settings_for(domain), region, neighbours) {}
  Peer(const Settings& settings, std::uint32_t region, std::initializer_list<std::uint32_t> neighbours)
      : participant(settings),
        transport(participant, {.region = static_cast<core::RegionId>(region),
                                .neighbours = regions(neighbours),
                                .map_version = kMapVersion,
                                .region_count = 16}),
        region_(static_cast<core::RegionId>(region)) {}

  void send_batch(core::Step stamp, std::size_t auras = 3) {
    core::Outbox outbox;
    outbox.aura = messages::testing::batch_of(auras, region());
    outbox.aura.stamp = stamp;
    for (core::AuraRecord& aura : outbox.aura.updates) aura.stamp = std::min(aura.stamp, stamp);
    transport.send(outbox);
  }
  core::RegionId region() const { return region_; }

  Participant participant;
  DdsTransport transport;
  core::Inbox inbox;
  core::RegionId region_{};
};

/// Takes until `done` holds; false at the deadline.
inline bool take_until(Peer& peer, const std::function<bool()>& done, std::chrono::nanoseconds time_out = kDeadline) {
  const auto deadline = std::chrono::steady_clock::now() + time_out;
  while (true) {
    peer.transport.take(peer.inbox);
    if (done()) {
      return true;
    }
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= 0ns) {
      return false;
    }
    peer.transport.wait_for_arrival(std::min<std::chrono::nanoseconds>(left, 50ms));
  }
}

}  // namespace aurasim::dds::testing
