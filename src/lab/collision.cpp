#include "lab/collision.h"

namespace aurasim::lab {
namespace {

Campaign without_jobs(const CollisionPlan& plan) {
  Campaign campaign;
  campaign.variants = all_variants(plan.auras, plan.syncs);
  campaign.repeats = plan.repeats;
  return campaign;
}

}  // namespace

Campaign collision_campaign(const CollisionPlan& plan) {
  Campaign campaign = without_jobs(plan);
  for (const PairKind pairs : plan.pairs) {
    for (const Series& series : thesis_series()) {
      const bool head_on = pairs == PairKind::kHeadOn;
      add_jobs(campaign, pairs, thinned(series, head_on ? plan.values_of_head_on_pairs : plan.values_of_other_pairs));
    }
  }
  return campaign;
}

Campaign loss_campaign(const CollisionPlan& plan) {
  Campaign campaign = without_jobs(plan);
  add_jobs(campaign, PairKind::kHeadOn, thinned(loss_series(), plan.values_of_head_on_pairs));
  return campaign;
}

}  // namespace aurasim::lab
