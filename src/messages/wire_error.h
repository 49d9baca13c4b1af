// Why a sample from the wire was refused. Refused samples are counted and dropped; they never assert.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "core/ids.h"

namespace aurasim::messages {

/// The number that every message carries. Changes with any change of idl/, and of which messages nodes wait for.
inline constexpr std::uint16_t kProtocolVersion = 26;

/// Bodies, manifolds, ... in one message; more are refused.
inline constexpr std::size_t kMaxRows = 1'000'000;

enum class WireError : std::uint8_t {
  kMalformed,   ///< the bytes are not the announced type
  kVersion,     ///< another protocol version
  kGeneration,  ///< another generation of the run than expected
  kMapVersion,  ///< another region map than expected
  kSource,      ///< names another source or destination region than its partition
  kLength,      ///< arrays that belong together differ in length
  kTooLarge,    ///< more elements than any sane message has
  kNotFinite,   ///< NaN or infinity
  kEnum,        ///< unknown enumerator or flag bit
  kRotation,    ///< not a unit quaternion or not a rotation matrix, by more than kRotationTolerance
  kRange,       ///< an index, id, count or quantity out of its range, or out of order
  kParts,       ///< a message in parts of which some are missing, or do not fit together
};
inline constexpr std::size_t kWireErrorKinds = 12;
inline constexpr double kRotationTolerance = 1e-3;

std::string_view name_of(WireError error);

/// Samples refused, by kind.
class WireErrors {
 public:
  void add(WireError error, std::uint64_t count = 1) { counts_[static_cast<std::size_t>(error)] += count; }
  std::uint64_t count(WireError error) const { return counts_[static_cast<std::size_t>(error)]; }
  std::uint64_t total() const;

 private:
  std::array<std::uint64_t, kWireErrorKinds> counts_{};
};

/// Values that the receiver requires of a message. Nothing: any value is accepted.
struct Expected {
  std::optional<std::uint64_t> map_version;
  std::optional<core::Generation> generation;
  std::optional<core::RegionId> source;
  std::optional<core::RegionId> destination;
  // Indices at or above these are refused.
  std::uint32_t region_count = 1U << 20;
  std::uint32_t prototype_count = 0xffff'ffffU;
  std::uint32_t static_count = 0xffff'ffffU;
  std::uint32_t joint_count = 0xffff'ffffU;
  double block_m = 0;  ///< side of the blocks; 0: not known, so blocks are not checked
};

}  // namespace aurasim::messages
