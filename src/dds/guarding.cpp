#include "dds/guarding.h"

#include "dds/domain.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

rtps::GuardReport guarded(Participant& participant) { return participant.domain().guard().report(); }

std::vector<rtps::GuardReport::Address> take_new_refusals(Participant& participant) {
  return participant.domain().guard().take_new_sources();
}

}  // namespace aurasim::dds
