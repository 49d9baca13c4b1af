// Samples of one topic that the hub of a run keeps for processes that come later, as the writers of the samples do
// themselves in a run without hub.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <set>

#include "dds/watch.h"

namespace aurasim::dds {

/// A sample as its writer has published it.
struct PassedSample {
  std::shared_ptr<void> sample;  ///< of the topic's generated type
  Guid writer;                   ///< who has published it
  std::int64_t number = 0;       ///< its number among the samples of that writer
  std::array<std::uint8_t, 16> key{};
};

class KeptSamples {
 public:
  /// Keeps the last `depth` samples of each writer and key.
  explicit KeptSamples(std::size_t depth) : depth_(depth) {}

  void keep(PassedSample sample);
  /// Drops the samples of writers that are not among `live`. True if there were any: then the rest has to be published
  /// anew, after all that is published has been dropped.
  bool keep_only_of(const std::set<Guid>& live);
  /// In the order in which they came.
  const std::list<PassedSample>& all() const { return samples_; }

 private:
  std::size_t depth_;
  std::list<PassedSample> samples_;
};

}  // namespace aurasim::dds
