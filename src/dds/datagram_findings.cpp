#include "dds/datagram_findings.h"

#include <algorithm>

namespace aurasim::dds {

const char* name_of(Refusal refusal) {
  static constexpr std::array<const char*, kRefusalCount> kNames = {
      "header",    "submessage", "length", "statistics", "sequence number", "number set", "fragment", "parameter list",
      "parameter", "payload",    "rate",   "jump",       "unfinished",      "too many"};
  return kNames.at(static_cast<std::size_t>(refusal));
}

void Findings::clear() {
  size = 0;
  claims.clear();
  hidden_parameters.clear();
  hidden_submessages.clear();
  hidden_bits.clear();
}

void Findings::hide(std::span<std::uint8_t> bytes) const {
  for (const std::size_t at : hidden_parameters) bytes[at] = bytes[at + 1] = 0;
  for (const std::size_t at : hidden_submessages) bytes[at] = 0x01;
  for (const std::size_t at : hidden_bits) std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 4, 0);
}

}  // namespace aurasim::dds
