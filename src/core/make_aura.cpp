#include "core/make_aura.h"

#include "core/none_aura.h"
#include "core/sphere_aura.h"
#include "core/swept_aura.h"

namespace aurasim::core {

std::unique_ptr<const Aura> make_aura(const AuraRules& rules, const ClearanceQuery& clearance) {
  switch (rules.kind) {
    case AuraKind::kNone:
      if (rules.redo) return std::make_unique<BlindAura>(rules, clearance);
      return std::make_unique<NoneAura>(rules, clearance);
    case AuraKind::kThesis:
      return std::make_unique<ThesisAura>(rules, clearance);
    case AuraKind::kTight:
      return std::make_unique<TightAura>(rules, clearance);
    case AuraKind::kSwept:
      break;
  }
  return std::make_unique<SweptAura>(rules, clearance);
}

}  // namespace aurasim::core
