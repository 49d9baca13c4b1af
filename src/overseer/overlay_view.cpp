#include "overseer/overlay_view.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace aurasim::overseer {
namespace {

std::vector<SlotPair> slots_of(const std::vector<core::BodyPair>& pairs, const WorldView& view) {
  std::vector<SlotPair> slots;
  for (const core::BodyPair& pair : pairs) {
    const ViewBody* const a = view.find(pair.a);
    const ViewBody* const b = view.find(pair.b);
    if (a != nullptr && b != nullptr) slots.push_back({a->slot, b->slot});
  }
  return slots;
}

}  // namespace

void OverlayView::look(dds::Participant& participant, const dds::ObserverSettings& settings, const Show& wanted,
                       const core::Scene& scene, const WorldView& view) {
  if (!wanted.auras) {
    auras_.reset();
    aura_of_.clear();
  } else if (!auras_) {
    auras_ = std::make_unique<dds::AuraWatch>(participant, settings);
  }
  if (!wanted.links && !wanted.contacts) {
    graphs_.reset();
    graph_of_.clear();
  } else if (!graphs_) {
    graphs_ = std::make_unique<dds::ClusterGraphWatch>(participant, settings);
  }
  if (auras_) look_at_auras(scene, view);
  if (!graphs_) return;
  for (core::ClusterGraph& graph : graphs_->take()) {
    const core::RegionId source = graph.source;
    graph_of_.insert_or_assign(source, std::move(graph));
  }
}

void OverlayView::look_at_auras(const core::Scene& scene, const WorldView& view) {
  for (const core::AuraBatch& batch : auras_->take()) {
    if (batch.full) {
      std::erase_if(aura_of_, [&](const auto& entry) {
        const ViewBody* body = view.find(entry.first);
        return body == nullptr || body->host == batch.source;
      });
    }
    for (const core::AuraRecord& aura : batch.updates) {
      if (core::value_of(aura.prototype) >= scene.prototypes.size()) continue;
      const core::Prototype& prototype = scene.prototypes[core::value_of(aura.prototype)];
      aura_of_[aura.id] = {static_cast<float>(core::bounding_radius(scene.shapes[prototype.shape].shape)),
                           static_cast<float>(aura.speed_m_s)};
    }
    for (const core::BodyId id : batch.deletes) aura_of_.erase(id);
  }
  std::erase_if(aura_of_, [&](const auto& entry) { return view.find(entry.first) == nullptr; });
}

void OverlayView::forget() {
  auras_.reset();
  graphs_.reset();
  aura_of_.clear();
  graph_of_.clear();
}

Bytes OverlayView::encode(const WorldView& view, double ahead_s) const {
  std::vector<AuraDisc> discs;
  for (const auto& [id, aura] : aura_of_) {
    const float reach_m = aura.radius_m + aura.speed_m_s * static_cast<float>(ahead_s);
    if (const ViewBody* body = view.find(id)) discs.push_back({body->slot, reach_m});
  }
  std::vector<SlotPair> links, contacts;
  for (const auto& [source, graph] : graph_of_) {
    if (graph.generation != view.generation()) continue;
    std::ranges::copy(slots_of(graph.links, view), std::back_inserter(links));
    std::ranges::copy(slots_of(graph.contacts, view), std::back_inserter(contacts));
  }
  return encode_overlays(discs, links, contacts);
}

}  // namespace aurasim::overseer
