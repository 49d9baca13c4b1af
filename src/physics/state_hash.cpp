#include "physics/state_hash.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <numeric>

namespace aurasim::physics {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

constexpr std::size_t kWords = 3 + 3 + 9 + 3 + 3 + 1;

/// All that the hash of a body is made of.
std::array<std::uint64_t, kWords> words_of(const core::BodyRecord& body) {
  std::array<std::uint64_t, kWords> words;
  auto next = words.begin();
  const auto add_all = [&](const auto& numbers) {
    for (Eigen::Index i = 0; i < numbers.size(); ++i) *next++ = std::bit_cast<std::uint64_t>(numbers.data()[i]);
  };
  *next++ = core::value_of(body.id);
  *next++ = static_cast<std::uint64_t>(body.activation_state);
  *next++ = std::bit_cast<std::uint64_t>(body.deactivation_time);
  add_all(body.p_WB);
  add_all(body.R_WB);
  add_all(body.v_WB);
  add_all(body.w_WB);
  *next = std::uint64_t{static_cast<std::uint32_t>(body.block.x)} << 32U | static_cast<std::uint32_t>(body.block.y);
  return words;
}

/// Writes the hashes of `kBodies` bodies. Each word of a hash has to wait for the one before, so several hashes at once
/// take little longer than one.
template <std::size_t kBodies>
void write_hashes(const core::BodyRecord* bodies, std::uint64_t* hashes) {
  std::array<std::array<std::uint64_t, kWords>, kBodies> words;
  for (std::size_t i = 0; i < kBodies; ++i) words[i] = words_of(bodies[i]);
  std::array<std::uint64_t, kBodies> sums{};
  for (std::size_t word = 0; word < kWords; ++word) {
    for (std::size_t i = 0; i < kBodies; ++i) sums[i] = mixed(sums[i] + 0x9e3779b97f4a7c15 + words[i][word]);
  }
  std::copy(sums.begin(), sums.end(), hashes);
}

constexpr std::size_t kAtOnce = 4;

}  // namespace

std::uint64_t state_hash(const core::BodyRecord& body) {
  std::uint64_t hash = 0;
  write_hashes<1>(&body, &hash);
  return hash;
}

void state_hashes(std::span<const core::BodyRecord> bodies, std::span<std::uint64_t> hashes) {
  std::size_t i = 0;
  for (; i + kAtOnce <= bodies.size(); i += kAtOnce) write_hashes<kAtOnce>(&bodies[i], &hashes[i]);
  for (; i < bodies.size(); ++i) write_hashes<1>(&bodies[i], &hashes[i]);
}

std::uint64_t state_hash_sum(std::span<const core::BodyRecord> bodies) {
  std::array<std::uint64_t, kAtOnce> hashes{};
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < bodies.size(); i += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, bodies.size() - i);
    state_hashes(bodies.subspan(i, count), hashes);
    sum = std::accumulate(hashes.begin(), hashes.begin() + static_cast<std::ptrdiff_t>(count), sum);
  }
  return sum;
}

}  // namespace aurasim::physics
