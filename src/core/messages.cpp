#include "core/messages.h"

namespace aurasim::core {

void Inbox::clear() {
  auras.clear();
  hand_offs.clear();
  acks.clear();
  peers.clear();
}

void Outbox::clear() {
  aura.updates.clear();
  aura.deletes.clear();
  aura.hand_offs.clear();
  aura.dead.clear();
  aura.claims.clear();
  hand_offs.clear();
  acks.clear();
}

}  // namespace aurasim::core
