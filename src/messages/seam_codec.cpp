#include "messages/seam_codec.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <ranges>
#include <span>

#include "aurasim.h"
#include "messages/header_check.h"

namespace aurasim::messages {
namespace {

void encode_header(const SeamHeader& header, std::uint64_t map_version, wire::SeamPiece& out) {
  out.source(core::value_of(header.source));
  out.destination(core::value_of(header.destination));
  out.version(kProtocolVersion);
  out.generation(header.generation);
  out.stamp(header.step);
  out.map_version(map_version);
  out.sequence_number(header.number);
}

bool is_sound_question(const wire::SeamPiece& in) {
  const auto& lacking = in.lacking();
  return in.octets().empty() && !in.goes_on() && !lacking.empty() && lacking.size() <= kMostLacking &&
         lacking.front() > 0 && std::ranges::adjacent_find(lacking, std::greater_equal<>{}) == lacking.end();
}

}  // namespace

void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::byte> octets, bool goes_on,
            wire::SeamPiece& out) {
  encode_header(header, map_version, out);
  out.goes_on(goes_on);
  out.lacking().clear();
  out.octets().resize(octets.size());
  if (!octets.empty()) std::memcpy(out.octets().data(), octets.data(), octets.size());
}

void encode(const SeamHeader& header, std::uint64_t map_version, std::span<const std::uint32_t> lacking,
            wire::SeamPiece& out) {
  encode_header(header, map_version, out);
  out.goes_on(false);
  out.octets().clear();
  out.lacking().assign(lacking.begin(), lacking.end());
}

Decoded<SeamPiece> decode(const wire::SeamPiece& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return *error;
  if (const auto error = check_source(in, expected)) return *error;
  if (const auto error = check_destination(in, expected)) return *error;
  if (in.stamp() < 0) return WireError::kRange;
  if (in.sequence_number() == 0 ? !is_sound_question(in) : !in.lacking().empty()) return WireError::kRange;
  return SeamPiece{.header = {core::RegionId{in.source()}, core::RegionId{in.destination()}, in.generation(),
                              in.stamp(), in.sequence_number()},
                   .goes_on = in.goes_on(),
                   .octets = std::as_bytes(std::span(in.octets())),
                   .lacking = in.lacking()};
}

std::uint32_t empty_piece_B() {
  constexpr std::uint32_t kEncapsulation_B = 4;
  // The constructor of a generated type registers all types, which takes long.
  static const auto empty_B =
      kEncapsulation_B + static_cast<std::uint32_t>(wire::SeamPiece::getCdrSerializedSize(wire::SeamPiece{}));
  return empty_B;
}

}  // namespace aurasim::messages
