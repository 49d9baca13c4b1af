#include "host/long_work.h"

#include <algorithm>

#include <fmt/format.h>

namespace aurasim::host {

void LongWork::reached(double share, Clock::time_point now) {
  const Clock::duration taken = now - begin_;
  if (taken < next_) return;
  next_ = taken + std::min<Clock::duration>(taken, std::chrono::seconds(10));
  tell_(fmt::format("{}: {:.0f}%, {:.0f} s", what_, 100 * share, std::chrono::duration<double>(taken).count()));
}

}  // namespace aurasim::host
