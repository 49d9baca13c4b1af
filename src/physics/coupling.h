// What a world needs to be coupled with the worlds of other regions (docs/design.md, "Coupled regions"): bodies near
// borders are known to both sides, and contacts between bodies of several regions are solved by each of them.
#pragma once

#include "core/block_owners.h"
#include "core/seam_mail.h"

namespace aurasim::physics {

/// Both pointers have to outlive the world.
struct Coupling {
  core::RegionId self{};
  const core::BlockOwners* owners = nullptr;
  core::SeamMail* mail = nullptr;
};

/// Calls work(region) for each other region.
template <class Work>
void for_each_peer(const Coupling& coupling, Work&& work) {
  for (std::uint32_t i = 0; i < coupling.owners->size(); ++i) {
    if (core::RegionId{i} != coupling.self) work(core::RegionId{i});
  }
}

}  // namespace aurasim::physics
