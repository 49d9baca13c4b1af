// How observers read a topic: what is not sound is counted, not passed on.
#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "dds/codec.h"
#include "dds/endpoints.h"
#include "dds/observer_settings.h"

namespace aurasim::dds {

inline Expected expected_of(const ObserverSettings& settings) {
  Expected expected;
  expected.map_version = settings.map_version;
  expected.region_count = settings.region_count;
  expected.prototype_count = settings.prototype_count;
  return expected;
}

template <class WireMessage, class Message>
void drain(Reader& reader, WireMessage& sample, const Expected& expected, std::vector<Message>& out,
           WireErrors& refused) {
  while (reader.take(&sample)) {
    auto decoded = decode(sample, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      refused.add(*error);
    } else {
      out.push_back(std::move(std::get<Message>(decoded)));
    }
  }
}

}  // namespace aurasim::dds
