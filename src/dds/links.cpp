#include "dds/links.h"

#include <algorithm>
#include <iterator>

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

/// Regions that come later have readers of their own: to change the partitions of one that is matched would announce it
/// to everybody anew, and so would one that goes.
void Links::add(const std::vector<RegionId>& regions, bool are_first) {
  std::vector<RegionId> missing;
  std::ranges::copy_if(regions, std::back_inserter(missing), [this](RegionId region) { return !find(region); });
  if (are_first) return add_reader(missing, true);
  for (const RegionId region : missing) add_reader({region}, false);
}

void Links::add_reader(const std::vector<RegionId>& regions, bool are_first) {
  if (regions.empty()) return;
  EndpointSpec batches{TopicId::kAura, {}, self_};
  for (const RegionId region : regions) {
    batches.partitions.push_back(topics::partition_of(TopicId::kAura, {.source = region, .life = life_}));
  }
  const Reader& auras = *aura_readers_.emplace_back(std::make_unique<Reader>(domain_, batches, domain_.wakeup()));
  for (const RegionId region : regions) {
    Link& link = *links_.emplace_back(std::make_unique<Link>());
    link.region = region;
    link.auras = &auras;
    link.is_first = are_first;
    if (are_first) migrations_to(link);
  }
}

void Links::remove(RegionId region) {
  const auto link = std::ranges::find(links_, region, [](const auto& one) { return one->region; });
  if (link == links_.end() || (*link)->is_first) return;
  const Reader* const auras = (*link)->auras;
  links_.erase(link);
  std::erase_if(aura_readers_, [auras](const auto& reader) { return reader.get() == auras; });
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
