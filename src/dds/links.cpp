#include "dds/links.h"

#include <algorithm>

namespace aurasim::dds {

using core::RegionId;

Links::Links(Domain& domain, RegionId self, core::Generation life, const std::vector<RegionId>& regions)
    : domain_(domain),
      self_(self),
      life_(life),
      aura_writer_(domain, on(TopicId::kAura, {.source = self, .life = life}, self), domain.wakeup()),
      migration_reader_(domain, on(TopicId::kMigration, {.destination = self, .life = life}, self), domain.wakeup()) {
  add(regions, true);
}

/// Regions that come later have another reader of auras: to change the partitions of one that is matched would announce
/// it to everybody anew.
void Links::add(const std::vector<RegionId>& regions, bool are_first) {
  EndpointSpec batches{TopicId::kAura, {}, self_};
  std::vector<RegionId> missing;
  for (const RegionId region : regions) {
    if (find(region) != nullptr) continue;
    missing.push_back(region);
    batches.partitions.push_back(topics::partition_of(TopicId::kAura, {.source = region, .life = life_}));
  }
  if (missing.empty()) return;
  const Reader& auras = *aura_readers_.emplace_back(std::make_unique<Reader>(domain_, batches, domain_.wakeup()));
  for (const RegionId region : missing) {
    Link& link = *links_.emplace_back(std::make_unique<Link>());
    link.region = region;
    link.auras = &auras;
    link.is_first = are_first;
    if (are_first) migrations_to(link);
  }
}

Writer& Links::migrations_to(Link& link) {
  if (!link.migration_writer) {
    const topics::Route route{.source = self_, .destination = link.region, .life = life_};
    link.migration_writer.emplace(domain_, on(TopicId::kMigration, route, self_), domain_.wakeup());
  }
  return *link.migration_writer;
}

Link* Links::find(RegionId region) {
  const auto found = std::ranges::find(links_, region, [](const auto& link) { return link->region; });
  return found == links_.end() ? nullptr : found->get();
}

Link* Links::of_writer(const Guid& writer, RegionId claimed) {
  const auto home = domain_.speakers().home_of(writer);
  if (home) return find(*home);
  return domain_.speakers().is_at_home(writer, claimed) ? find(claimed) : nullptr;
}

std::optional<ProcessPrefix> Links::node_of(const Link& link) const {
  if (const auto node = domain_.speakers().of(link.region)) return node;
  const RemoteWriter first = link.auras->watch().latest({}, link.region);
  return first.order == 0 ? std::nullopt : std::optional(first.guid.guidPrefix);
}

RemoteWriter Links::aura_writer_of(const Link& link) const {
  return link.auras->watch().latest(node_of(link), link.region);
}

bool Links::is_lost(const Link& link) const {
  const RemoteWriter writer = aura_writer_of(link);
  return link.lost || writer.lost || (link.match != 0 && writer.order != link.match);
}

std::size_t Links::endpoints_of(const Link& link) { return (link.is_first ? 3 : 2) + (link.migration_writer ? 1 : 0); }

std::vector<std::string> Links::unmatched(const Link& link) const {
  std::vector<std::string> missing;
  const std::optional<ProcessPrefix> node = node_of(link);
  const auto need = [&](bool there, const char* name) {
    if (!there) missing.emplace_back(name);
  };
  need(link.auras->watch().any_matched(node, link.region), "its aura writer");
  need(aura_writer_.reaches(link.region), "its aura reader");
  need(!link.is_first || migration_reader_.watch().any_matched(node, link.region), "its migration writer");
  need(!link.migration_writer || link.migration_writer->reaches(link.region), "its migration reader");
  return missing;
}

}  // namespace aurasim::dds
