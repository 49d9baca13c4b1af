// Topics interest and observation: observers say what they want, and each node tells each of them what it has of it. An
// observer never holds up a node: what it is too slow for is overwritten.
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

/// The end of a node. Used by one thread. The participant must outlive it.
class ObservationServer {
 public:
  ObservationServer(Participant& participant, core::RegionId region);
  ~ObservationServer();

  /// Takes in what observers want by now, and forgets those that are gone. Cheap if nobody is there. At most
  /// core::kMostObservers are served; those who want something unsound, or too often, are refused and counted.
  void look();
  bool anybody_asks() const;

  struct Asked {
    const core::Interest* interest = nullptr;
    std::uint64_t arrivals = 0;  ///< grows when it wants something else, or can be told for the first time
    std::uint64_t key = 0;       ///< of this observer
  };
  /// Of those who can be told: ascending by client. Valid until the next look().
  const std::vector<Asked>& asked() const;
  /// False while too much of what it was sent is under way: it would lose some of it.
  bool takes_more(std::uint64_t key);
  /// False when the write failed.
  bool send(std::uint64_t key, const core::Observation& observation);

  /// Interests that were unsound, too many, or another client's.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The end of an observer, a client of its own. Used by one thread. The participant must outlive it.
class ObserverEndpoint {
 public:
  ObserverEndpoint(Participant& participant, const ObserverSettings& settings);
  /// Says that it wants nothing any more.
  ~ObserverEndpoint();

  std::uint64_t client() const;
  /// Takes the place of what it wanted before; client and sequence are filled in. Returns the sequence. Throws DdsError
  /// when the write failed.
  std::uint64_t want(core::Interest interest);
  /// In order of arrival, at most 64 of those that have come.
  std::vector<core::Observation> take();
  /// Returns when something arrived, or at the time-out.
  void wait(std::chrono::nanoseconds time_out);
  /// As the run is now. Where that is news, what is wanted is said once more, under the same sequence: a state that was
  /// told before has been refused here by the old settings, and nodes tell it again to whoever asks again. Throws
  /// DdsError when the write failed.
  void use(const ObserverSettings& settings);

  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
