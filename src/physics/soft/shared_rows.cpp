// Which movers coupled regions exchange before which phase.
#include <algorithm>

#include "core/keep_one_of_each.h"
#include "physics/soft/seam_parcels.h"
#include "physics/soft/shared.h"

namespace aurasim::physics {

using soft::Mover;

std::uint8_t SoftShared::elsewhere(const Touched& touched, core::RegionId other) {
  std::uint8_t phases = touched.phases & bit_of(SoftPhase::kCorners);
  // All that a body touches across its edge is hosted by the owner of the block there.
  if (touched.across != other) phases |= touched.phases & bit_of(SoftPhase::kEdges);
  return phases;
}

SoftPhase SoftShared::sent_before(SoftPhase phase, const Known& body, core::RegionId other) const {
  const bool is_ours = body.host == coupling_.self;
  std::uint8_t phases = is_ours ? elsewhere(body.touched, other) : body.elsewhere;
  // Both regions know that both solve the contacts around the corner.
  const bool both_solve =
      body.around_corner != nullptr && (!is_ours || std::ranges::count(body.around_corner->hosts, other) > 0);
  if (both_solve) phases &= static_cast<std::uint8_t>(~bit_of(SoftPhase::kCorners));
  while (phase > SoftPhase::kCorners) {
    const auto last = static_cast<SoftPhase>(static_cast<std::uint8_t>(phase) - 1);
    if ((phases & bit_of(last)) != 0) break;
    phase = last;
  }
  return phase;
}

void SoftShared::order_rows(ByPhase<Rows>& rows, const SoftPatches* bouncing) const {
  const auto may_bounce = [&](std::size_t i) { return bouncing->may_bounce(i); };
  for (auto& of_phase : rows) of_phase.clear();
  for (std::size_t phase = 0; phase < kSoftPhases; ++phase) {
    for (const auto& [host, common] : common_[phase]) {
      if (bouncing != nullptr && std::ranges::none_of(common.patches, may_bounce)) continue;
      for (const std::int32_t ours : common.ours) {
        const SoftPhase before = sent_before(static_cast<SoftPhase>(phase), known(ours), host);
        rows[static_cast<std::size_t>(before)][host].ours.push_back(ours);
      }
      for (const std::int32_t theirs : common.theirs) {
        const SoftPhase before = sent_before(static_cast<SoftPhase>(phase), known(theirs), host);
        rows[static_cast<std::size_t>(before)][host].theirs.push_back(theirs);
      }
    }
  }
  for (auto& of_phase : rows) {
    for (auto& [host, with] : of_phase) {
      for (std::vector<std::int32_t>* const movers : {&with.ours, &with.theirs}) {
        core::keep_one_of_each(*movers, [this](std::int32_t mover) { return known(mover).id; });
      }
    }
  }
}

void SoftShared::note_bounces(const SoftPatches& patches) { order_rows(bouncing_rows_, &patches); }

void SoftShared::exchange(SoftPhase phase, bool bounces, Mover* movers) {
  const auto& rows = (bounces ? bouncing_rows_ : rows_)[static_cast<std::size_t>(phase)];
  for (const auto& [host, with] : rows) {
    if (with.ours.empty()) continue;
    parcel_.clear();
    for (const std::int32_t ours : with.ours) write_row(movers[ours], parcel_);
    coupling_.mail->post(host, parcel_.bytes());
  }
  for (const auto& [host, with] : rows) {
    if (with.theirs.empty()) continue;
    const std::span<const std::byte> bytes = coupling_.mail->fetch(host);
    if (bytes.size() != with.theirs.size() * kRowBytes) {
      throw BadParcel("another region sent other bodies than those in common contacts");
    }
    ParcelReader parcel(bytes);
    for (const std::int32_t theirs : with.theirs) read_row(movers[theirs], parcel);
  }
}

}  // namespace aurasim::physics
