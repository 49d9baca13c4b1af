// What pages draw over the bodies: auras as the nodes tell each other, and topic bonds, which a node writes only while
// somebody listens.
#pragma once

#include <memory>
#include <vector>

#include "core/bonds.h"
#include "core/messages.h"
#include "dds/participant.h"
#include "dds/replica_bus.h"

namespace aurasim::dds {

/// Used by one thread. The participant must outlive it.
class BondsWriter {
 public:
  BondsWriter(Participant& participant, core::RegionId region);
  ~BondsWriter();

  bool anybody_listens() const;
  /// What cannot be sent at once is not sent: the next tick tells all anew.
  void send(const core::Bonds& bonds);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The bonds of all regions: some may be missed. The participant must outlive it.
class BondsWatch {
 public:
  BondsWatch(Participant& participant, const ObserverSettings& settings);
  ~BondsWatch();

  std::vector<core::Bonds> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The auras of all regions: some may be missed. The participant must outlive it.
class AuraWatch {
 public:
  AuraWatch(Participant& participant, const ObserverSettings& settings);
  ~AuraWatch();

  std::vector<core::AuraBatch> take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
