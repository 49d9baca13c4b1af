// Overlays that pages may draw over the bodies: how far auras reach, which bodies are linked into clusters, which
// touch. The nodes publish this only while a page wants it.
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
  /// Takes in what the nodes have published. `wanted`: overlays that any page wants.
  void look(dds::Participant& participant, const dds::ObserverSettings& settings, const Show& wanted,
            const core::Scene& scene, const WorldView& view);
  /// Drops everything, because a new map or scene makes it obsolete.
  void forget();

  /// Encodes the overlays. Bodies that the view does not know are left out. `ahead_s`: how long an aura holds, seconds.
  Bytes encode(const WorldView& view, double ahead_s) const;

 private:
  struct Aura {
    float radius_m = 0;  ///< radius of the bounding sphere
    float speed_m_s = 0;
  };
  void look_at_auras(const core::Scene& scene, const WorldView& view);

  std::unique_ptr<dds::AuraWatch> auras_;
  std::unique_ptr<dds::ClusterGraphWatch> graphs_;
  std::map<core::BodyId, Aura> aura_of_;
  std::map<core::RegionId, core::ClusterGraph> graph_of_;
};

}  // namespace aurasim::overseer
