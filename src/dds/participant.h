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

  /// Says that the owner is not stuck. Transports and buses call it on every use; call it in a longer computation.
  /// Any thread.
  void progress();

  /// True when this process was once held up (stopped, starved, suspended) for longer than its participant's lease. Its
  /// peers have given it up, and Fast DDS 2.9.1 does not always match it again (3 of 25 did not within 30 s): it had
  /// better end. Any thread.
  bool outlived_its_lease() const;

  /// True when all traffic is on loopback, which cannot be cut: whoever is silent there is dead.
  bool stays_on_this_host() const;

  struct ImpairmentReport {
    Impairment impairment;  ///< as the profile and the settings make it
    ImpairmentCounters datagrams;
  };
  /// Nothing where nothing is impaired. Any thread.
  std::optional<ImpairmentReport> impairment() const;
  /// Samples of processes that are no nodes of the run, and repeats for them, that were refused. Any thread.
  std::uint64_t refused_of_strangers() const;
  /// Who else is in the domain, with keys and without. Any thread.
  PeersByKeys peers_by_keys() const;
  /// For the log: who is refused what, since the last call. Any thread.
  std::vector<std::string> take_said();

  /// Sends what impairment still holds back. For a process that ends without destroying this. Any thread.
  void flush_delayed();

  const Settings& settings() const { return settings_; }
  Domain& domain() { return *domain_; }

 private:
  Settings settings_;
  std::unique_ptr<Domain> domain_;
};

}  // namespace aurasim::dds
