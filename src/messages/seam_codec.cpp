#include "messages/seam_codec.h"

#include <cstring>

#include "aurasim.h"
#include "messages/header_check.h"

namespace aurasim::messages {

void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::byte> octets,
            wire::SeamParcel& out) {
  out.source(core::value_of(header.source));
  out.destination(core::value_of(header.destination));
  out.version(kProtocolVersion);
  out.generation(header.generation);
  out.stamp(header.step);
  out.map_version(map_version);
  out.sequence_number(header.number);
  out.octets().resize(octets.size());
  if (!octets.empty()) std::memcpy(out.octets().data(), octets.data(), octets.size());
}

Decoded<SeamParcel> decode(const wire::SeamParcel& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return *error;
  if (const auto error = check_source(in, expected)) return *error;
  if (const auto error = check_destination(in, expected)) return *error;
  if (in.stamp() < 0 || in.sequence_number() == 0) return WireError::kRange;
  SeamParcel parcel{{core::RegionId{in.source()}, core::RegionId{in.destination()}, in.generation(), in.stamp(),
                     in.sequence_number()},
                    std::vector<std::byte>(in.octets().size())};
  if (!parcel.octets.empty()) std::memcpy(parcel.octets.data(), in.octets().data(), parcel.octets.size());
  return parcel;
}

}  // namespace aurasim::messages
