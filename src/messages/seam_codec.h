// Encodes messages/seam_piece.h as a wire type, and decodes it. Same contract as codec.h, except that the content of
// `octets` is checked by physics/.
#pragma once

#include <span>

#include "messages/codec.h"
#include "messages/seam_piece.h"

namespace aurasim::wire {
class SeamPiece;
}  // namespace aurasim::wire

namespace aurasim::messages {

/// Encodes a piece.
void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::byte> octets, bool goes_on,
            wire::SeamPiece& out);
/// Encodes a question.
void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::uint32_t> lacking,
            wire::SeamPiece& out);
/// The result refers to `in`.
Decoded<SeamPiece> decode(const wire::SeamPiece& in, const Expected& expected);

/// Serialized size of a piece without octets, with the encapsulation.
std::uint32_t empty_piece_B();

}  // namespace aurasim::messages
