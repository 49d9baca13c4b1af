#include "messages/interest_codec.h"

#include <optional>

#include "aurasim.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::Interest;
using core::value_of;
using core::WorldBox;

namespace {

using MaybeError = std::optional<WireError>;

constexpr std::uint8_t kAll = 1;
constexpr std::uint8_t kContacts = 2;
constexpr std::uint8_t kJoints = 4;
constexpr std::uint8_t kEnded = 8;
constexpr std::uint8_t kAnyFlags = kAll | kContacts | kJoints | kEnded;

MaybeError check_size(const wire::Interest& in) {
  if (in.body().size() > core::kMostWantedBodies || in.prototype().size() > core::kMostWantedPrototypes ||
      in.low().size() > 3 * core::kMostWantedBoxes) {
    return WireError::kTooLarge;
  }
  const bool fits = in.low().size() % 3 == 0 && in.low().size() == in.high().size();
  return fits ? MaybeError{} : WireError::kLength;
}

MaybeError check_values(const wire::Interest& in) {
  if (!all_finite(in.low()) || !all_finite(in.high())) return WireError::kNotFinite;
  if ((in.flags() & ~kAnyFlags) != 0) return WireError::kEnum;
  bool sound = in.client() != 0 && in.sequence_number() > 0 && in.every() <= core::kMostStatesBetween &&
               all_body_ids(in.body()) && strictly_ascending(in.body()) &&
               std::ranges::adjacent_find(in.prototype(), std::greater_equal<>{}) == in.prototype().end() &&
               all_within(in.low(), core::kFarthestBox_m) && all_within(in.high(), core::kFarthestBox_m);
  for (std::size_t i = 0; i < in.low().size(); ++i) sound = sound && in.low()[i] <= in.high()[i];
  return sound ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::Interest& in, const Expected& expected) {
  Expected of_any_map = expected;
  if (in.map_version() == 0) of_any_map.map_version.reset();
  if (const auto error = check_header(in, of_any_map)) return error;
  if (const auto error = check_size(in)) return error;
  return check_values(in);
}

std::uint8_t flags_of(const Interest& interest) {
  return static_cast<std::uint8_t>((interest.all ? kAll : 0) | (interest.contacts ? kContacts : 0) |
                                   (interest.joints ? kJoints : 0) | (interest.ended ? kEnded : 0));
}

}  // namespace

void encode(const Interest& interest, std::uint64_t map_version, wire::Interest& out) {
  out.client(interest.client);
  out.version(kProtocolVersion);
  out.generation(0);
  out.stamp(0);
  out.map_version(map_version);
  out.sequence_number(interest.sequence);
  out.every(interest.every);
  out.flags(flags_of(interest));
  fill(out.body(), interest.bodies, [](core::BodyId id) { return value_of(id); });
  fill(out.prototype(), interest.prototypes, [](core::PrototypeId id) { return value_of(id); });
  fill_wide<3>(out.low(), interest.boxes, [](const WorldBox& box, double* to) { put_vector(box.low, to); });
  fill_wide<3>(out.high(), interest.boxes, [](const WorldBox& box, double* to) { put_vector(box.high, to); });
}

Decoded<Interest> decode(const wire::Interest& in, const Expected& expected) {
  if (const auto error = check(in, expected)) return *error;
  Interest interest;
  interest.client = in.client();
  interest.sequence = in.sequence_number();
  interest.every = in.every();
  interest.all = (in.flags() & kAll) != 0;
  interest.contacts = (in.flags() & kContacts) != 0;
  interest.joints = (in.flags() & kJoints) != 0;
  interest.ended = (in.flags() & kEnded) != 0;
  for (const std::uint64_t id : in.body()) interest.bodies.push_back(static_cast<core::BodyId>(id));
  for (const std::uint32_t id : in.prototype()) interest.prototypes.push_back(static_cast<core::PrototypeId>(id));
  for (std::size_t i = 0; i < in.low().size() / 3; ++i) {
    interest.boxes.push_back({vector_at(in.low(), i), vector_at(in.high(), i)});
  }
  return interest;
}

}  // namespace aurasim::messages
