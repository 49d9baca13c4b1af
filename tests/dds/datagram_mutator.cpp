#include "datagram_mutator.h"

#include <algorithm>

namespace aurasim::dds::testing {
namespace {

/// Numbers that lengths, counts and sequence numbers trip over.
constexpr std::uint64_t kNasty[] = {0,
                                    1,
                                    2,
                                    3,
                                    4,
                                    0x7f,
                                    0xff,
                                    0x100,
                                    0x101,
                                    0x7fff,
                                    0xffff,
                                    0x10000,
                                    0x00ff'ffff,
                                    0x0fff'ffff,
                                    0x1fff'ffff,
                                    0x2000'0000,
                                    0x7fff'ffff,
                                    0x8000'0000,
                                    0xffff'ff00,
                                    0xffff'fffe,
                                    0xffff'ffff,
                                    0x1'0000'0000,
                                    0x7fff'ffff'ffff'ffff,
                                    0xffff'ffff'ffff'ffff};
constexpr std::uint8_t kIds[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d, 0x0e, 0x0f, 0x12,
                                 0x13, 0x15, 0x16, 0x30, 0x31, 0x32, 0x33, 0x34, 0x80, 0x81};
constexpr std::uint16_t kPids[] = {0x00, 0x01, 0x02,   0x05,   0x07,   0x0f,   0x15,   0x1a,   0x1b,   0x1d,
                                   0x21, 0x29, 0x2c,   0x2f,   0x31,   0x32,   0x35,   0x48,   0x50,   0x52,
                                   0x58, 0x59, 0x5a,   0x62,   0x69,   0x70,   0x71,   0x72,   0x73,   0x74,
                                   0x75, 0x77, 0x1001, 0x1002, 0x1005, 0x4014, 0x8002, 0x8005, 0x8006, 0x800f};

}  // namespace

void DatagramMutator::use(std::vector<Bytes> recorded) { recorded_ = std::move(recorded); }

Bytes DatagramMutator::noise(std::size_t longest) {
  Bytes bytes(below(longest + 1));
  for (auto& octet : bytes) octet = static_cast<std::uint8_t>(random_());
  return bytes;
}

std::vector<std::size_t> DatagramMutator::submessages(const Bytes& bytes) {
  std::vector<std::size_t> offsets;
  for (std::size_t at = 20; at + 4 <= bytes.size();) {
    offsets.push_back(at);
    const bool little = (bytes[at + 1] & 1) != 0;
    const std::size_t length = little ? bytes[at + 2] | bytes[at + 3] << 8 : bytes[at + 3] | bytes[at + 2] << 8;
    if (length == 0) break;
    at += 4 + (length + 3) / 4 * 4;
  }
  return offsets;
}

void DatagramMutator::flip_bits(Bytes& bytes) {
  for (std::size_t i = 0, times = 1 + below(8); i < times; ++i) {
    bytes[below(bytes.size())] ^= static_cast<std::uint8_t>(1U << below(8));
  }
}

void DatagramMutator::set_number(Bytes& bytes, std::size_t at) {
  std::uint64_t value = below(3) == 0 ? random_() >> below(64) : kNasty[below(std::size(kNasty))];
  const std::size_t size = std::size_t{1} << below(4);
  if (below(4) == 0) value = 0 - value;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
}

/// In one submessage: its kind, flags or length, a number, a parameter id, itself once more, or another's.
void DatagramMutator::change_submessage(Bytes& bytes) {
  const auto offsets = submessages(bytes);
  if (offsets.empty()) return;
  const std::size_t at = offsets[below(offsets.size())];
  const std::size_t begin = std::min(at + 4, bytes.size() - 1);
  switch (below(7)) {
    case 0:
      bytes[at] = kIds[below(std::size(kIds))];
      break;
    case 1:
      bytes[at + 1] ^= static_cast<std::uint8_t>(1U << below(5));
      break;
    case 2:
      set_number(bytes, at + 2);
      break;
    case 3: {  // where sequence numbers and counts are
      set_number(bytes, begin + 4 * below(12));
      break;
    }
    case 4: {
      const std::size_t where = begin + 4 * below((bytes.size() - begin) / 4 + 1);
      const std::uint16_t pid = kPids[below(std::size(kPids))];
      if (where + 1 < bytes.size()) {
        bytes[where] = static_cast<std::uint8_t>(pid);
        bytes[where + 1] = static_cast<std::uint8_t>(pid >> 8);
      }
      break;
    }
    case 5: {
      const Bytes copy(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end());
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(offsets[below(offsets.size())]), copy.begin(),
                   copy.end());
      break;
    }
    default: {
      const Bytes& other = any();
      const auto of_other = submessages(other);
      if (of_other.empty()) break;
      const auto from = other.begin() + static_cast<std::ptrdiff_t>(of_other[below(of_other.size())]);
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), from, other.end());
    }
  }
}

/// Speaks as another participant or writer, or to another.
void DatagramMutator::change_identity(Bytes& bytes) {
  const Bytes& other = any();
  if (below(2) == 0) {
    std::copy_n(other.begin() + 8, 12, bytes.begin() + 8);
    return;
  }
  const auto offsets = submessages(bytes), of_other = submessages(other);
  if (offsets.empty() || of_other.empty()) return;
  const std::size_t to = offsets[below(offsets.size())] + 4, from = of_other[below(of_other.size())] + 4;
  const std::size_t size = std::min(
      {std::size_t{16}, bytes.size() - std::min(bytes.size(), to), other.size() - std::min(other.size(), from)});
  std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(from), size, bytes.begin() + static_cast<std::ptrdiff_t>(to));
}

void DatagramMutator::change(Bytes& bytes) {
  switch (below(8)) {
    case 0:
      bytes.resize(below(bytes.size() + 1));
      break;
    case 1:
      flip_bits(bytes);
      break;
    case 2:
      set_number(bytes, below(bytes.size()));
      break;
    case 3:
      set_number(bytes, below(bytes.size()) / 4 * 4);
      break;
    case 4:
      change_identity(bytes);
      break;
    default:
      change_submessage(bytes);
  }
}

Bytes DatagramMutator::next() {
  constexpr std::size_t kLongest = 65'507;
  const std::size_t kind = below(100);
  if (kind < 3) return noise(1500);
  Bytes bytes = any();
  if (kind < 8) {
    bytes.resize(20);
    const Bytes tail = noise(600);
    bytes.insert(bytes.end(), tail.begin(), tail.end());
  } else if (kind < 10 && below(20) == 0) {
    bytes.resize(kLongest, static_cast<std::uint8_t>(random_()));
  } else if (kind > 12) {  // what is left goes as it was: a replay
    for (std::size_t i = 0, times = 1 + below(4); i < times && bytes.size() > 20; ++i) change(bytes);
  }
  if (bytes.size() > kLongest) bytes.resize(kLongest);
  return bytes;
}

}  // namespace aurasim::dds::testing
