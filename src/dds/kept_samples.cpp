#include "dds/kept_samples.h"

#include <utility>

namespace aurasim::dds {

void KeptSamples::keep(PassedSample sample) {
  std::size_t count = 0;
  auto oldest = samples_.end();
  for (auto it = samples_.begin(); it != samples_.end(); ++it) {
    if (it->writer != sample.writer || it->key != sample.key) continue;
    if (count++ == 0) oldest = it;
  }
  if (count >= depth_) samples_.erase(oldest);
  samples_.push_back(std::move(sample));
}

bool KeptSamples::keep_only_of(const std::set<Guid>& live) {
  return std::erase_if(samples_, [&](const PassedSample& one) { return !live.contains(one.writer); }) > 0;
}

}  // namespace aurasim::dds
