// The hash of Fowler, Noll and Vo, variant 1a, 64 bits, over a sequence of octets. Not for secrets.
#pragma once

#include <cstdint>
#include <string_view>

namespace aurasim::core {

class Fnv1a {
 public:
  void add_octet(std::uint8_t octet) { hash_ = (hash_ ^ octet) * kPrime; }
  /// Adds the eight octets of `word`, the lowest first.
  void add_word(std::uint64_t word) {
    for (int i = 0; i < 8; ++i, word >>= 8) add_octet(static_cast<std::uint8_t>(word));
  }
  /// Adds the octets of `text`, without its length.
  void add_text(std::string_view text) {
    for (const char c : text) add_octet(static_cast<std::uint8_t>(c));
  }
  std::uint64_t value() const { return hash_; }

  static constexpr std::uint64_t kPrime = 0x100000001b3;
  static constexpr std::uint64_t kOffsetBasis = 0xcbf29ce484222325;

 private:
  std::uint64_t hash_ = kOffsetBasis;
};

}  // namespace aurasim::core
