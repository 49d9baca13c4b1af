#include "messages/wire_error.h"

#include <numeric>

namespace aurasim::messages {

std::string_view name_of(WireError error) {
  static constexpr std::array<std::string_view, kWireErrorKinds> kNames = {
      "malformed", "version",    "generation", "map_version", "source", "length",
      "too_large", "not_finite", "enum",       "rotation",    "range",  "parts"};
  return kNames.at(static_cast<std::size_t>(error));
}

std::uint64_t WireErrors::total() const { return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}); }

}  // namespace aurasim::messages
