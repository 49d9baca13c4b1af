#include "process/world_meant.h"

namespace aurasim::process {

WorldMeant world_meant(core::Generation meant, const Worlds& known) {
  if (known.restored && meant < *known.restored) return WorldMeant::kPast;
  if (known.begun == meant) return WorldMeant::kPresent;
  const bool is_announced = known.waits_for == meant || known.restored == meant || known.reset_to == meant;
  const bool is_later = !known.begun || meant > *known.begun;
  return is_announced && is_later ? WorldMeant::kNext : WorldMeant::kOver;
}

}  // namespace aurasim::process
