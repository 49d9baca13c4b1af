#include "lab/loss.h"

namespace aurasim::lab {

Campaign loss_campaign(const CollisionPlan& plan) {
  Campaign campaign;
  campaign.name = "loss";
  campaign.variants = all_variants(plan.auras, plan.syncs);
  campaign.repeats = plan.repeats;
  campaign.seed = plan.seed;
  campaign.substeps = plan.substeps;
  for (const PairKind pairs : plan.pairs)
    add_jobs(campaign, pairs, thinned(loss_series(), plan.values_of_head_on_pairs));
  return campaign;
}

}  // namespace aurasim::lab
