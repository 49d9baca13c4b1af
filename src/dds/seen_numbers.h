// Which samples of other processes have come by a hub. A hub that was started anew publishes what its predecessor has
// published, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

#include "dds/watch.h"

namespace aurasim::dds {

class SeenNumbers {
 public:
  /// True if sample `number` of `writer` is newer than all before. A hub keeps the order of each writer's samples.
  bool is_news(const Guid& writer, std::int64_t number) {
    if (newest_.size() >= kMostWriters && !newest_.contains(writer)) newest_.clear();
    const auto [known, is_first] = newest_.try_emplace(writer, number);
    if (!is_first && number <= known->second) return false;
    known->second = number;
    return true;
  }

  static constexpr std::size_t kMostWriters = 8192;

 private:
  std::map<Guid, std::int64_t> newest_;
};

}  // namespace aurasim::dds
