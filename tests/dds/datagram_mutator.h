// Datagrams that are almost of a run: random, truncated, and changed from recorded ones. By seed.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace aurasim::dds::testing {

using Bytes = std::vector<std::uint8_t>;

class DatagramMutator {
 public:
  explicit DatagramMutator(std::uint64_t seed) : random_(seed) {}

  /// Replaces what the next ones are made from. Must not be empty.
  void use(std::vector<Bytes> recorded);
  Bytes next();

 private:
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }
  const Bytes& any() { return recorded_[below(recorded_.size())]; }
  Bytes noise(std::size_t longest);
  void change(Bytes& bytes);
  void flip_bits(Bytes& bytes);
  void set_number(Bytes& bytes, std::size_t at);
  void change_submessage(Bytes& bytes);
  void change_identity(Bytes& bytes);
  /// Offsets of submessages, as far as their lengths lead.
  static std::vector<std::size_t> submessages(const Bytes& bytes);

  std::mt19937_64 random_;
  std::vector<Bytes> recorded_;
};

}  // namespace aurasim::dds::testing
