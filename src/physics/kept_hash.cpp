#include "physics/kept_hash.h"

#include <span>

#include "physics/moving_body.h"
#include "physics/state_hash.h"

namespace aurasim::physics {

std::uint64_t KeptHash::sum(BodyTable& table, ChangedBodies& changed) {
  changed.for_each(table, [this](HostedBody& body, std::size_t) {
    if (!body.born || is_guest(*body.rigid)) return;
    bodies_[count_] = &body;
    records_[count_++] = body.record();
    if (count_ == kAtOnce) renew();
  });
  renew();
  changed.clear();
  return sum_;
}

void KeptHash::renew() {
  std::array<std::uint64_t, kAtOnce> hashes;
  state_hashes(std::span(records_).first(count_), hashes);
  for (std::size_t i = 0; i < count_; ++i) {
    sum_ += hashes[i] - bodies_[i]->hash;
    bodies_[i]->hash = hashes[i];
  }
  count_ = 0;
}

}  // namespace aurasim::physics
