#include "lab/collision.h"

namespace aurasim::lab {

Campaign collision_campaign(const CollisionPlan& plan) {
  Campaign campaign;
  campaign.name = "collision";
  campaign.variants = all_variants(plan.auras, plan.syncs);
  campaign.repeats = plan.repeats;
  campaign.seed = plan.seed;
  campaign.substeps = plan.substeps;
  for (const PairKind pairs : plan.pairs) {
    for (const Series& series : thesis_series()) {
      const bool head_on = pairs == PairKind::kHeadOn;
      add_jobs(campaign, pairs, thinned(series, head_on ? plan.values_of_head_on_pairs : plan.values_of_other_pairs));
    }
  }
  return campaign;
}

}  // namespace aurasim::lab
