#include "physics/contact_records.h"

#include <algorithm>
#include <tuple>

#include "physics/prefetch.h"

namespace aurasim::physics {

void write_contacts(std::vector<KeyedContact>& contacts, core::ClusterState& cluster) {
  std::sort(contacts.begin(), contacts.end(), [](const KeyedContact& a, const KeyedContact& b) {
    if (std::tie(a.object0, a.object1) != std::tie(b.object0, b.object1)) {
      return std::tie(a.object0, a.object1) < std::tie(b.object0, b.object1);
    }
    return a.contact.parts() < b.contact.parts();
  });
  cluster.manifolds.clear();
  std::size_t points = 0;
  for (const auto& [object0, object1, contact] : contacts) {
    const std::size_t count = contact.count();
    cluster.manifolds.push_back(
        {object0, object1, static_cast<std::uint32_t>(points), static_cast<std::uint32_t>(count)});
    points += count;
  }
  cluster.points.resize(points * core::kContactPointDoubles);
  double* row = cluster.points.data();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (i + kPrefetchDistance < contacts.size()) contacts[i + kPrefetchDistance].contact.prefetch();
    contacts[i].contact.write(row);
    row += contacts[i].contact.count() * core::kContactPointDoubles;
  }
}

}  // namespace aurasim::physics
