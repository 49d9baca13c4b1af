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

class CoupledWorlds {
 public:
  CoupledWorlds(const core::Scene& scene, const Settings& settings, const core::RegionMap& map,
                std::span<const core::BodyRecord> bodies)
      : owners_(map, settings.block_m, core::usual_reach_m(radii(scene), settings.block_m)), seams_(map.size()) {
    RegionWorld whole(scene, settings);
    whole.add(bodies);  // gives bodies their blocks
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      const core::RegionId self{i};
      worlds_.push_back(std::make_unique<RegionWorld>(scene, settings));
      worlds_.back()->couple({self, &owners_, &seams_.of(self)});
      std::vector<core::BodyRecord> here;
      for (const core::BodyRecord& body : whole.peek_all().bodies) {
        if (owners_.owner(body.block) == self) here.push_back(body);
      }
      worlds_.back()->add(here);
    }
  }

  /// All worlds compute the next state. Throws what the first of them throws.
  void step() {
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
    worlds_[region]->couple({core::RegionId{region}, &owners_, &mail});
  }
  RegionWorld& operator[](std::size_t region) { return *worlds_[region]; }
  std::size_t size() const { return worlds_.size(); }
  std::size_t parcels() const { return seams_.count(); }

 private:
  static std::vector<double> radii(const core::Scene& scene) {
    std::vector<double> all;
    for (const core::Prototype& kind : scene.prototypes)
      all.push_back(core::bounding_radius(scene.shapes[kind.shape].shape));
    return all;
  }

  core::BlockOwners owners_;
  transport::MemorySeams seams_;
  std::vector<std::unique_ptr<RegionWorld>> worlds_;
};

}  // namespace aurasim::physics::testing
