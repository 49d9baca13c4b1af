#include "physics/state_hash.h"

#include <bit>

namespace aurasim::physics {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

class Hash {
 public:
  void add(std::uint64_t word) { state_ = mixed(state_ + 0x9e3779b97f4a7c15 + word); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  template <class Matrix>
  void add_all(const Matrix& numbers) {
    for (Eigen::Index i = 0; i < numbers.size(); ++i) add(numbers.data()[i]);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace

std::uint64_t state_hash(const core::BodyRecord& body) {
  Hash hash;
  hash.add(core::value_of(body.id));
  hash.add(static_cast<std::uint64_t>(body.activation_state));
  hash.add(body.deactivation_time);
  hash.add_all(body.p_WB);
  hash.add_all(body.R_WB);
  hash.add_all(body.v_WB);
  hash.add_all(body.w_WB);
  hash.add(std::uint64_t{static_cast<std::uint32_t>(body.block.x)} << 32U | static_cast<std::uint32_t>(body.block.y));
  return hash.value();
}

}  // namespace aurasim::physics
