#include "dds/hub_silence.h"

#include <algorithm>

#include "dds/speakers.h"

namespace aurasim::dds {

void HubSilence::look(const std::vector<RemoteWriter>& writers, const Speakers& speakers, Time now) {
  if (!last_look_ || now - *last_look_ > kSleep) awake_since_ = now;
  last_look_ = now;
  hub_since_.reset();
  for (const RemoteWriter& writer : writers) {
    if (!writer.matched || writer.silent_since || !speakers.is_hub(writer.guid.guidPrefix)) continue;
    hub_since_ = std::min(hub_since_.value_or(writer.since), writer.since);
  }
}

bool HubSilence::is_believed(Time heard, std::chrono::nanoseconds limit, Time now) const {
  if (!hub_since_ || !awake_since_ || now - *awake_since_ <= kAwake) return false;
  return now - std::max(heard, *hub_since_) > limit;
}

}  // namespace aurasim::dds
