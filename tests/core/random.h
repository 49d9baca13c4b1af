// Randomness of the tests: a named seed that is printed, the same on every machine. AURASIM_TEST_SEED replays another.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string_view>

#include "core/body_state.h"

namespace aurasim::core::testing {

class Random {
 public:
  /// Prints the seed under `name`.
  explicit Random(std::string_view name, std::uint64_t seed = 1) {
    if (const char* wanted = std::getenv("AURASIM_TEST_SEED")) seed = std::strtoull(wanted, nullptr, 10);
    std::printf("[   seed   ] %.*s: %llu\n", static_cast<int>(name.size()), name.data(),
                static_cast<unsigned long long>(seed));
    bits_.seed(seed);
  }

  /// Uniform in [low, high).
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  bool chance(double probability) { return between(0, 1) < probability; }
  /// Uniform in [0, n).
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits_() % n); }
  Vec3 in_box(double half_size) {
    const double x = between(-half_size, half_size);
    const double y = between(-half_size, half_size);
    return {x, y, between(-half_size, half_size)};
  }
  /// Uniform on the unit sphere.
  Vec3 direction() {
    const double z = between(-1, 1);
    const double turn = between(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  std::mt19937_64& bits() { return bits_; }

 private:
  std::mt19937_64 bits_;
};

}  // namespace aurasim::core::testing
