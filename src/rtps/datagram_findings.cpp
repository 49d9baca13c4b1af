#include "rtps/datagram_findings.h"

#include <algorithm>
#include <cstring>

namespace aurasim::rtps {

const char* name_of(Refusal refusal) {
  static constexpr std::array<const char*, kRefusalCount> kNames = {
      "header",          "submessage", "length",   "statistics",
      "sequence number", "number set", "fragment", "parameter list",
      "parameter",       "payload",    "rate",     "jump",
      "unfinished",      "too many",   "repeat",   "not listened to"};
  return kNames.at(static_cast<std::size_t>(refusal));
}

std::size_t PrefixHash::operator()(const GuidPrefix& prefix) const {
  std::uint64_t low = 0;
  std::uint32_t high = 0;
  std::memcpy(&low, prefix.data(), sizeof low);
  std::memcpy(&high, prefix.data() + sizeof low, sizeof high);
  return (low ^ (std::uint64_t{high} << 29)) * 0x9e3779b97f4a7c15ULL >> 17;
}

void Findings::clear() {
  size = 0;
  introduces = false;
  claims.clear();
  requests.clear();
  hidden_parameters.clear();
  hidden_submessages.clear();
  acknowledgements.clear();
}

/// Turns a submessage into padding. One that extends to the datagram's end is cut off instead, because as padding its
/// length 0 would mean "no content".
void Findings::hide_submessage(std::size_t at, bool goes_to_end) {
  if (goes_to_end) {
    size = std::min(size, at);
  } else {
    hidden_submessages.push_back(at);
  }
}

/// Overwrites an acknowledgement: reader and writer come first, then the base, the number of bits and the bits.
void Findings::Acknowledgement::write_over(std::span<std::uint8_t> submessage) const {
  constexpr std::size_t kBase = 4 + 8, kBits = kBase + 8;
  constexpr std::uint8_t kFinalFlag = 2;
  const bool little = (submessage[1] & 1) != 0;
  const auto write = [&](std::size_t offset, std::uint64_t number) {
    for (std::size_t i = 0; i < 4; ++i) {
      submessage[offset + i] = static_cast<std::uint8_t>(number >> 8 * (little ? i : 3 - i));
    }
  };
  submessage[1] |= kFinalFlag;
  write(kBase, base >> 32);
  write(kBase + 4, base & 0xffff'ffffU);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= std::uint32_t{submessage[kBits + i]} << 8 * (little ? i : 3 - i);
  std::fill_n(submessage.begin() + kBits + 4, (bits + 31) / 32 * 4, std::uint8_t{0});
}

void Findings::hide(std::span<std::uint8_t> bytes) const {
  for (const std::size_t at : hidden_parameters) bytes[at] = bytes[at + 1] = 0;
  for (const std::size_t at : hidden_submessages) bytes[at] = 0x01;
  for (const Acknowledgement& one : acknowledgements) one.write_over(bytes.subspan(one.at));
}

}  // namespace aurasim::rtps
