// The auras of one region that are for us, as its batches change them.
#pragma once

#include <vector>

#include "core/audience.h"
#include "core/messages.h"

namespace aurasim::core {

class PublishedAuras {
 public:
  explicit PublishedAuras(RegionId self) : self_(audience_of(self)) {}

  /// Brings the updates and deletes of a batch into ascending order of id, which merge() needs.
  static void sort(AuraBatch& batch);
  /// Takes in the next batch, which has been sorted.
  void merge(const AuraBatch& batch);
  /// Ascending id.
  const std::vector<AuraRecord>& auras() const { return auras_; }

 private:
  Audience self_;
  std::vector<AuraRecord> auras_, merged_;
};

}  // namespace aurasim::core
