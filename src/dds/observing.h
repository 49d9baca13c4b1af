// Expectations of observers about the messages of the run that they watch.
#pragma once

#include "dds/observer_settings.h"
#include "messages/wire_error.h"

namespace aurasim::dds {

inline messages::Expected expected_of(const ObserverSettings& settings) {
  messages::Expected expected;
  expected.map_version = settings.map_version;
  expected.region_count = settings.region_count;
  expected.prototype_count = settings.prototype_count;
  return expected;
}

}  // namespace aurasim::dds
