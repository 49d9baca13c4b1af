// One DDS participant per process: profiles, types, topics, discovery and the proof of life. Everything else in this
// folder borrows it and must be destroyed before it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dds/peers_by_keys.h"
#include "dds/settings.h"

namespace aurasim::dds {

class Domain;  // domain.h, with Fast DDS behind it

class Participant {
 public:
  /// Joins the domain. Throws DdsError with the file and the profile that is missing or wrong.
  explicit Participant(const Settings& settings);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Marks progress: the owner is not stuck. Transports and buses call it on every use; a longer computation must call
  /// it itself. Callable from any thread.
  void progress();

  /// True when all traffic is on loopback. Loopback cannot be cut, so a process that is silent there is dead.
  bool stays_on_this_host() const;

  /// True if what is for all nodes reaches them: with discovery: neighbours only once a hub is there.
  bool has_way_to_all() const;

  struct ImpairmentReport {
    Impairment impairment;  ///< result of the profile and the settings
    ImpairmentCounters datagrams;
  };
  /// Returns the impairment and its counters; nothing if the network is not impaired. Callable from any thread.
  std::optional<ImpairmentReport> impairment() const;
  /// Number of samples from processes outside the run, and of retransmissions to them, that were refused. Callable from
  /// any thread.
  std::uint64_t refused_of_strangers() const;
  /// Numbers of other participants in the domain, with keys and without. Callable from any thread.
  PeersByKeys peers_by_keys() const;
  /// Messages for the log about refusals since the last call. Callable from any thread.
  std::vector<std::string> take_said();

  /// Sends at once the datagrams that impairment still holds back. For a process that ends without destroying this
  /// object. Callable from any thread.
  void flush_delayed();

  const Settings& settings() const { return settings_; }
  Domain& domain() { return *domain_; }

 private:
  Settings settings_;
  std::unique_ptr<Domain> domain_;
};

}  // namespace aurasim::dds
