// Which foreign auras meet our clusters, and which hosts they pull them to (docs/design.md, "Who leaves").
#include <algorithm>
#include <optional>

#include "core/interest_matching.h"
#include "core/progress.h"

namespace aurasim::core {

/// Applies the pairs that a redo brings together. Two of our bodies are treated as if a joint held them. One of ours
/// and a foreign one are treated as if their auras met.
void InterestMatching::bring_together(const Snapshot& snapshot) {
  joined_.clear();
  expecting_.clear();
  together_pairs_.clear();
  for (const TogetherPair& pair : together_) {
    if (pair.until < snapshot.step) continue;
    const std::optional<std::uint32_t> a = own_.find(pair.a);
    const std::optional<std::uint32_t> b = own_.find(pair.b);
    if (a && b) joined_.push_back({*a, *b});
    for (const auto& [own, other] : {std::pair(a, pair.b), std::pair(b, pair.a)}) {
      if (!own) continue;
      expecting_.push_back(*own);
      if (const std::optional<std::uint32_t> foreign = foreign_.find(other))
        together_pairs_.push_back({*foreign, *own});
    }
  }
}

/// True if an own cluster that so far would go to `other` goes to `host` instead. A host that is dead pulls nothing.
bool InterestMatching::pulls_from(RegionId host, RegionId other) const {
  return host < other && std::ranges::binary_search(live_, host);
}

void InterestMatching::judge() {
  hits_.clear();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    Progress::mark_now_and_then(i);
    judge(pairs_[i]);
  }
  for (const Pair& pair : together_pairs_) {
    hits_.push_back({pair.own, foreign_[pair.foreign].host});
    hit(pair.own, foreign_[pair.foreign].host);
  }
  complete_who_may_leave();
  clear_verdicts();
  for (const Hit& each : hits_) hit(each.own, each.host);
  if (homeward_hops() == 0) return;
  for (const Pair& pair : pairs_) judge_expected(pair);
}

/// Until now, bodies were judged as members of smaller clusters, held together by contacts and joints only. Of a
/// cluster that nobody pulls and that has a part in our region it does not matter who else belongs to it: it stays.
void InterestMatching::complete_who_may_leave() {
  for (const Hit& hit : hits_) {
    if (pulls_from(hit.host, vicinity_.self)) clusters_.complete(hit.own);
  }
  for (const std::uint32_t i : expecting_) clusters_.complete(i);
  for (const std::uint32_t i : outside_) clusters_.complete_outside(i);
}

/// Notes that an aura of `host` met the cluster of body `own`. The host keeps the foreign body, or our cluster goes to
/// it.
void InterestMatching::hit(std::uint32_t own, RegionId host) {
  const std::uint32_t cluster = clusters_.of(own);
  Verdict& verdict = verdicts_[cluster];
  verdict.touched = true;
  judged_.push_back(cluster);
  if (pulls_from(host, verdict.pulled_to)) verdict.pulled_to = host;
}

bool InterestMatching::meets(const Foreign& foreign, const Path& own, int hops) const {
  return foreign.ghost ? aura_.meets_ghost(foreign.path, own, hops) : aura_.meets(foreign.path, own, hops);
}

void InterestMatching::judge(const Pair& pair) {
  const Foreign& f = foreign_[pair.foreign];
  const bool pulls = pulls_from(f.host, pulled_to(pair.own));
  if ((touched(pair.own) && !pulls) || !meets(f, own_.path(pair.own), hops_[pair.own])) return;
  hits_.push_back({pair.own, f.host});
  hit(pair.own, f.host);
}

void InterestMatching::judge_expected(const Pair& pair) {
  if (!outside(pair.own) || touched(pair.own) || expected(pair.own)) return;
  if (!meets(foreign_[pair.foreign], own_.path(pair.own), hops_[pair.own] + homeward_hops())) return;
  verdicts_[clusters_.of(pair.own)].expected = true;
  judged_.push_back(clusters_.of(pair.own));
}

}  // namespace aurasim::core
