// Carries parcels between coupled regions in the middle of a step (docs/design.md, "Coupled regions").
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>

#include "core/ids.h"

namespace aurasim::core {

/// Thrown in the middle of a step when another region cannot go on with it.
class SeamsBroken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class SeamMail {
 public:
  virtual ~SeamMail() = default;

  /// Begins a step, which computes state `step`. Parcels for the step before can still be
  /// fetched by others, and those for earlier ones are dropped.
  virtual void begin(Generation, Step) {}
  /// What has been posted and fetched since begin() was no exchange in the middle of the step, but before it.
  virtual void begin_exchanges() {}
  /// Posts a parcel. Parcels to one region arrive in the order in which they were posted.
  virtual void post(RegionId to, std::span<const std::byte> parcel) = 0;
  /// Waits for the next parcel from a region. Valid until the next call for that region. Throws SeamsBroken if it will
  /// not come.
  virtual std::span<const std::byte> fetch(RegionId from) = 0;
};

}  // namespace aurasim::core
