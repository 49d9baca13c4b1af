// What pages may have drawn over the bodies: how far auras reach, which bodies are linked into clusters, which touch.
// The nodes are asked for it only while a page wants it.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/scene.h"
#include "dds/overlay_bus.h"
#include "overseer/frame_codec.h"
#include "overseer/page_input.h"
#include "overseer/world_view.h"

namespace aurasim::overseer {

class OverlayView {
 public:
  /// Takes in what the nodes have published. `wanted`: by any page.
  void look(dds::Participant& participant, const dds::ObserverSettings& settings, const Show& wanted,
            const core::Scene& scene, const WorldView& view);
  /// Another map or scene: what was known is of another world.
  void forget();

  /// Bodies that the view does not know are left out. `ahead_s`: for how long an aura holds, seconds.
  Bytes encode(const WorldView& view, double ahead_s) const;

 private:
  struct Aura {
    float radius_m = 0;  ///< of the bounding sphere
    float speed_m_s = 0;
  };
  void look_at_auras(const core::Scene& scene, const WorldView& view);

  std::unique_ptr<dds::AuraWatch> auras_;
  std::unique_ptr<dds::ClusterGraphWatch> graphs_;
  std::map<core::BodyId, Aura> aura_of_;
  std::map<core::RegionId, core::ClusterGraph> graph_of_;
};

}  // namespace aurasim::overseer
