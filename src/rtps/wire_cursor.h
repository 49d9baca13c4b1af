// Reads a datagram from the front, and never beyond the end of its part. Pure.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace aurasim::rtps {

/// Reading more than left() bytes yields zeros and sets failed().
class WireCursor {
 public:
  WireCursor(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t end, bool little)
      : bytes_(bytes), at_(at), end_(end), little_(little) {}

  std::size_t at() const { return at_; }
  std::size_t left() const { return end_ - at_; }
  bool little() const { return little_; }
  bool failed() const { return failed_; }

  std::uint8_t u8() { return number<std::uint8_t>(); }
  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  /// Reads a 64-bit number as two halves, the high one first.
  std::uint64_t u32_pair() {
    const std::uint64_t high = u32();
    return high << 32 | u32();
  }
  /// Reads a sequence number. Negative ones become larger than every limit.
  std::uint64_t sequence_number() { return u32_pair(); }
  /// Reads octets in their order, whatever the endianness.
  template <class Array>
  Array octets() {
    Array array{};
    if (take(array.size())) std::memcpy(array.data(), bytes_.data() + at_ - array.size(), array.size());
    return array;
  }
  std::uint32_t entity() {
    const auto o = octets<std::array<std::uint8_t, 4>>();
    return std::uint32_t{o[0]} << 24 | std::uint32_t{o[1]} << 16 | std::uint32_t{o[2]} << 8 | o[3];
  }
  void skip(std::size_t count) { take(count); }
  /// Skips to a multiple of 4 from the datagram's begin. Padding may be missing at the very end.
  void align() { skip(std::min(left(), (4 - at_ % 4) % 4)); }
  /// Splits off the next `count` bytes as a part of their own.
  WireCursor part(std::size_t count) {
    const std::size_t begin = at_;
    if (!take(count)) return {bytes_, at_, at_, little_};
    return {bytes_, begin, begin + count, little_};
  }
  void set_little(bool little) { little_ = little; }
  std::uint8_t peek(std::size_t offset) const { return bytes_[at_ + offset]; }

 private:
  bool take(std::size_t count) {
    if (count > left()) {
      failed_ = true;
      at_ = end_;
      return false;
    }
    at_ += count;
    return true;
  }
  template <class Number>
  Number number() {
    if (!take(sizeof(Number))) return 0;
    Number value = 0;
    const std::uint8_t* from = bytes_.data() + at_ - sizeof(Number);
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      const std::size_t octet = little_ ? sizeof(Number) - 1 - i : i;
      value = static_cast<Number>(static_cast<std::uint64_t>(value) << 8 | from[octet]);
    }
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_, end_;
  bool little_, failed_ = false;
};

}  // namespace aurasim::rtps
