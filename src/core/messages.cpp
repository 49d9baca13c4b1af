#include "core/messages.h"

namespace aurasim::core {

const char* name_of(MessageKind kind) { return kind == MessageKind::kAura ? "aura batch" : "hand-off"; }

void Inbox::clear() {
  auras.clear();
  hand_offs.clear();
  refusals.clear();
  peers.clear();
}

void Outbox::clear() {
  aura.updates.clear();
  aura.deletes.clear();
  aura.hand_offs.clear();
  hand_offs.clear();
}

}  // namespace aurasim::core
