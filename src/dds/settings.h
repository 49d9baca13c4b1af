// Settings with which a process joins a run's DDS domain. Filled from a launch file by the caller.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/discovery.h"
#include "dds/impairment.h"
#include "security/key_files.h"

namespace aurasim::dds {

class Introductions;

struct Settings {
  std::uint32_t domain = 0;
  /// XML profiles. Profile `x` is taken from this file as `<stem>_x` (hosts.xml: `hosts_aura_writer`) or else as `x`;
  /// what the file lacks comes from `aurasim.xml` beside it, or in the folder above. Of a participant profile
  /// `<stem>_impairment` only the properties count; they are laid over those of the participant.
  std::filesystem::path profiles;
  /// Addresses that may carry traffic. If not empty it replaces the white list of every transport of the profile; {"*"}
  /// removes the white list. Empty: the profile decides.
  std::vector<std::string> interfaces;
  config::Discovery discovery = config::Discovery::kAuto;
  /// Set in the hub of Discovery::kNeighbours: who is to be introduced to whom.
  std::shared_ptr<Introductions> introductions;
  /// "address" or "address:port" (UDP); replaces the profile's initial peers. For a hub: the hubs of other sites.
  std::vector<std::string> peers;
  /// Address of the site's hub (Discovery::kNeighbours). Empty: the first of `interfaces`, or loopback.
  std::string hub;
  /// Overrides the profile's properties aurasim.impair.*.
  ImpairmentOverrides impairment;
  /// Separates the random numbers of participants. Each participant of a run uses a different value, so that they lose
  /// different datagrams with the same seed.
  std::uint64_t impairment_stream = 0;
  /// A process whose owner has neither called any transport or bus nor marked progress (core/progress.h) for this long
  /// no longer counts as alive.
  std::chrono::nanoseconds hang_limit = std::chrono::seconds(10);
  /// Called every quarter second by a thread of its own as long as this process counts as alive.
  std::function<void()> show_life;
  /// True: a process that is silent for one and a half leases counts as lost. False where another party knows which
  /// processes have died and reports it: then a silent process that still exists counts as slow. False only has an
  /// effect on loopback.
  bool believes_silence = true;
  /// Every endpoint announces the TypeObject of its topic, for generic tools. In a run one node is enough, because it
  /// has endpoints of every topic: what all of them announce is received by all others, and is most of the discovery.
  bool announces_types = true;
  /// Number of the run's nodes. With many of them all processes announce themselves, and ask readers of messages to all
  /// nodes for what they miss, less often (many_nodes.h).
  std::size_t nodes = 1;
  /// Keys to join a run with keys; nothing: an open run.
  std::optional<security::KeyFiles> keys;
  /// Called from DDS's threads with a sentence for each peer, reader or writer that is refused because of its keys.
  std::function<void(const std::string&)> report_refusal;
};

/// A profile, an endpoint or a peer is missing or wrong; what() names it and the file.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace aurasim::dds
