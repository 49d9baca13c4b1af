// Worlds of several regions that are coupled in memory, one thread each, beside the one world that they have to be.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/region_map.h"
#include "physics/region_world.h"
#include "physics/scenes.h"
#include "transport/memory_seams.h"

namespace aurasim::physics::testing {

inline Settings soft_step_with_blocks(double block_m) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  settings.block_m = block_m;
  settings.top_speed_m_s = 10;
  return settings;
}

class CoupledWorlds {
 public:
  CoupledWorlds(const core::Scene& scene, const Settings& settings, const core::RegionMap& map,
                std::span<const core::BodyRecord> bodies)
      : owners_(block_owners(map, scene, settings)), partners_(owners_), seams_(map.size()) {
    RegionWorld whole(scene, settings);
    whole.add(bodies);  // gives bodies their blocks
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      const core::RegionId self{i};
      worlds_.push_back(std::make_unique<RegionWorld>(scene, settings));
      worlds_.back()->couple({self, &owners_, &seams_.of(self), &partners_});
      std::vector<core::BodyRecord> here;
      for (const core::BodyRecord& body : whole.peek_all().bodies) {
        if (owners_.owner(body.block) == self) here.push_back(body);
      }
      worlds_.back()->add(here);
    }
  }

  /// All worlds compute the next state. Throws what the first of them throws.
  void step() {
    std::vector<core::Introduction> pairs;
    for (const auto& world : worlds_) {
      const std::vector<core::Introduction> some = world->introductions_ahead();
      if (!are_silent_) pairs.insert(pairs.end(), some.begin(), some.end());
    }
    introductions_ = pairs.size();
    partners_.begin(pairs);
    std::vector<std::function<void()>> works;
    for (const auto& world : worlds_) works.push_back([&world] { world->step(); });
    seams_.run(works);
    if (!seams_.is_empty()) throw std::logic_error("a parcel was not fetched");
  }

  std::vector<core::BodyRecord> records() {
    std::vector<core::BodyRecord> all;
    for (const auto& world : worlds_) {
      const auto some = world->records();
      all.insert(all.end(), some.begin(), some.end());
    }
    std::ranges::sort(all, {}, &core::BodyRecord::id);
    return all;
  }

  core::SeamMail& mail(std::uint32_t region) { return seams_.of(core::RegionId{region}); }
  /// From now on, a region has another mail.
  void use(std::uint32_t region, core::SeamMail& mail) {
    worlds_[region]->couple({core::RegionId{region}, &owners_, &mail, &partners_});
  }
  RegionWorld& operator[](std::size_t region) { return *worlds_[region]; }
  std::size_t size() const { return worlds_.size(); }
  std::size_t parcels() const { return seams_.count(); }
  /// From now on, nobody says who has to exchange parcels besides regions near each other.
  void silence() { are_silent_ = true; }
  /// Number of pairs of regions that were named for the last state.
  std::size_t introductions() const { return introductions_; }
  /// Have two regions exchanged parcels in the last state?
  bool have_met(std::uint32_t a, std::uint32_t b) const {
    return partners_.are_partners(core::RegionId{a}, core::RegionId{b});
  }

 private:
  core::BlockOwners owners_;
  core::SeamPartners partners_;
  transport::MemorySeams seams_;
  bool are_silent_ = false;
  std::size_t introductions_ = 0;
  std::vector<std::unique_ptr<RegionWorld>> worlds_;
};

}  // namespace aurasim::physics::testing
