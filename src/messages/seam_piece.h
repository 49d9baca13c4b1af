// Content of a message on topic seam: a piece of a parcel, or a question for pieces that have not come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/ids.h"

namespace aurasim::messages {

struct SeamHeader {
  core::RegionId source{};
  core::RegionId destination{};
  core::Generation generation = 0;
  core::Step step = 0;       ///< the state that is being computed
  std::uint32_t number = 0;  ///< of the pieces from source to destination in this step, from 1; 0: a question
};

/// A message as it lies in a sample.
struct SeamPiece {
  SeamHeader header;
  bool goes_on = false;               ///< the next piece is of the same parcel
  std::span<const std::byte> octets;  ///< of the parcel, which is read in physics/
  /// A question lists the numbers of pieces from destination to source that have not come, ascending. The last stands
  /// for all after it, too.
  std::span<const std::uint32_t> lacking;

  bool is_question() const { return header.number == 0; }
};

/// Most numbers in a question.
inline constexpr std::size_t kMostLacking = 128;

}  // namespace aurasim::messages
