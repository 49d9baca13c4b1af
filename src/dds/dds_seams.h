// Parcels between coupled regions over DDS (topic seam, best effort). The thread that computes writes them. A thread of
// DDS takes what comes, and answers who asks for a piece again (docs/decisions/0063-asked-for-again.md).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/seam_mail.h"
#include "dds/participant.h"
#include "dds/watch.h"

namespace aurasim::dds {

struct SeamSettings {
  core::RegionId region{};
  std::uint32_t region_count = 0;  ///< all others are peers
  /// Peers that parcels go to in most steps. They have writers from the beginning, at both ends.
  std::vector<core::RegionId> near;
  std::uint64_t map_version = 0;
  core::Generation life = 0;  ///< see TransportSettings
  /// True when a region's node is known to be lost.
  std::function<bool(core::RegionId)> is_lost;
  /// Why no node ends the step although none is known to be lost, such as that others wait for the run to go back.
  /// Nothing: no such reason. Asked several times a second while a parcel is waited for. Empty: there never is one.
  std::function<std::optional<std::string>()> why_stand = {};
  /// The process that is the region's node, if that is known; parcels of others are refused.
  std::function<std::optional<ProcessPrefix>(core::RegionId)> node_of = {};
};

struct SeamCounters {
  std::uint64_t questions = 0;  ///< for pieces that had not come
  std::uint64_t repeated = 0;   ///< pieces that were sent again
};

/// Times of the exchanges of one step. In an exchange a region posts parcels to others, and then fetches theirs.
struct ExchangeTimes {
  std::vector<double>
      seconds;  ///< of each exchange: posting, and waiting for parcels; without what is computed between
  core::RegionId waited_for{};  ///< the region that was waited for longest
  double waited_s = 0;          ///< for it, in all exchanges of the step
  SeamCounters counters;        ///< of what went on since these times were asked for last
};

class DdsSeams final : public core::SeamMail {
 public:
  /// The participant must outlive it.
  DdsSeams(Participant& participant, const SeamSettings& settings);
  ~DdsSeams() override;

  /// Number of the region's endpoints that have to be matched.
  std::size_t endpoints_of(core::RegionId region) const;
  /// Names of those that are not matched yet.
  std::vector<std::string> unmatched(core::RegionId region) const;

  /// The exchanges since begin().
  const ExchangeTimes& times();
  /// Since the beginning.
  SeamCounters counters() const;

  void begin(core::Generation generation, core::Step step) override;
  void begin_exchanges() override;
  /// The first parcel to a region that is not near makes the writer. Throws core::SeamsBroken if it cannot be sent.
  void post(core::RegionId to, std::span<const std::byte> parcel) override;
  /// Throws core::SeamsBroken once the region's node is lost, or nobody ends the step.
  std::span<const std::byte> fetch(core::RegionId from) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
