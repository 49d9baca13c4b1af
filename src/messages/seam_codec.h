// Encodes messages/seam_parcel.h as a wire type, and decodes it. Same contract as codec.h, except that the content of
// `octets` is checked by physics/.
#pragma once

#include "messages/codec.h"
#include "messages/seam_parcel.h"

namespace aurasim::wire {
class SeamParcel;
}  // namespace aurasim::wire

namespace aurasim::messages {

void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::byte> octets,
            wire::SeamParcel& out);
Decoded<SeamParcel> decode(const wire::SeamParcel& in, const Expected& expected);

}  // namespace aurasim::messages
