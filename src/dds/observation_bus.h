// Topics interest and observation: observers publish what they want to observe, and each node sends each of them its
// share of it. An observer never holds up a node: samples that it is too slow for are overwritten.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/interest.h"
#include "core/observation.h"
#include "dds/observer_settings.h"
#include "dds/participant.h"

namespace aurasim::dds {

/// A node's endpoint: receives interests and sends observations. Used by one thread. The participant must outlive it.
class ObservationServer {
 public:
  ObservationServer(Participant& participant, core::RegionId region);
  ~ObservationServer();

  /// Applies the interests that have arrived, and forgets observers that are gone. Cheap if there are none. Serves at
  /// most core::kMostObservers; unsound interests, and those that come too often, are refused and counted.
  void look();
  bool anybody_asks() const;

  struct Asked {
    const core::Interest* interest = nullptr;
    std::uint64_t arrivals = 0;  ///< grows when its interest changes, or when it is matched for the first time
    std::uint64_t key = 0;       ///< key of this observer
  };
  /// Interests of observers that can be sent to, ascending by client. Valid until the next look().
  const std::vector<Asked>& asked() const;
  /// False while too many observations for it are under way: it would lose some.
  bool takes_more(std::uint64_t key);
  /// Sends an observation to the observer `key`. Returns false when the write failed.
  bool send(std::uint64_t key, const core::Observation& observation);

  /// Number of interests refused: unsound, too many, or in another client's name.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// An observer's endpoint; each has a client id of its own. Used by one thread. The participant must outlive it.
class ObserverEndpoint {
 public:
  ObserverEndpoint(Participant& participant, const ObserverSettings& settings);
  /// Withdraws the interest.
  ~ObserverEndpoint();

  std::uint64_t client() const;
  /// Publishes an interest, which replaces the former one; client and sequence are filled in. Returns the sequence.
  /// Throws DdsError when the write failed.
  std::uint64_t want(core::Interest interest);
  /// Returns observations in order of arrival, at most 64 per call.
  std::vector<core::Observation> take();
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);
  /// Sets the settings of the run as it is now. If they have changed, the interest is published again under the same
  /// sequence: an observation sent before was refused here by the old settings, and nodes send it again to an observer
  /// that repeats its interest. Throws DdsError when the write failed.
  void use(const ObserverSettings& settings);

  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
