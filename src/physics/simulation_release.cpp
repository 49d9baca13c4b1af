// Release of bodies from a simulation, with everything that a hand-off has to carry.
#include <limits>
#include <stdexcept>
#include <string>

#include "core/progress.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// Cluster number of a body that stays.
constexpr std::uint32_t kStays = std::numeric_limits<std::uint32_t>::max();

}  // namespace

/// By place in the table: the leaving cluster of the body, or kStays.
std::vector<std::uint32_t> Simulation::membership(std::span<const std::span<const core::BodyId>> clusters) const {
  std::vector<std::uint32_t> cluster_at(table_.size(), kStays);
  for (std::uint32_t cluster = 0; cluster < clusters.size(); ++cluster) {
    for (const core::BodyId id : clusters[cluster]) {
      const HostedBody* const body = table_.find(id);
      if (body == nullptr) throw std::invalid_argument("body " + std::to_string(core::value_of(id)) + " is not here");
      cluster_at[static_cast<std::size_t>(body - table_.bodies().data())] = cluster;
    }
  }
  return cluster_at;
}

struct Simulation::Copies {
  std::vector<core::ClusterState> clusters;
  std::uint64_t across = 0;  ///< contacts and joints with bodies outside the cluster
};

Simulation::Copies Simulation::copy(const std::vector<std::uint32_t>& cluster_at, std::size_t count, bool whole) const {
  Copies copies;
  copies.clusters.resize(count);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (cluster_at[i] != kStays) copies.clusters[cluster_at[i]].bodies.push_back(table_[i].record());
  }
  std::vector<std::vector<KeyedContact>> contacts(count);
  world_.for_each_contact([&](const ContactView& contact) {
    const int index0 = contact.body0().getUserIndex();
    const int index1 = contact.body1().getUserIndex();
    const std::uint32_t cluster0 = is_static(index0) ? kStays : cluster_at[static_cast<std::size_t>(index0)];
    const std::uint32_t cluster1 = is_static(index1) ? kStays : cluster_at[static_cast<std::size_t>(index1)];
    if (cluster0 == kStays && cluster1 == kStays) return;
    if (is_static(index0) || is_static(index1) || cluster0 == cluster1) {
      const std::uint32_t cluster = cluster0 != kStays ? cluster0 : cluster1;
      contacts[cluster].push_back({ref_of(contact.body0()), ref_of(contact.body1()), contact});
    } else {
      ++copies.across;
      if (!whole) return;
      for (const std::uint32_t cluster : {cluster0, cluster1}) {
        if (cluster == kStays) continue;
        contacts[cluster].push_back({ref_of(contact.body0()), ref_of(contact.body1()), contact});
      }
    }
  });
  for (std::size_t i = 0; i < count; ++i) {
    core::ClusterState& cluster = copies.clusters[i];
    core::Progress::mark();
    write_contacts(contacts[i], cluster);
    copies.across += joints_.append_to(cluster);
  }
  return copies;
}

core::ClusterState Simulation::peek(std::span<const core::BodyId> bodies) const {
  return std::move(copy(membership({&bodies, 1}), 1, false).clusters.front());
}

std::vector<core::ClusterState> Simulation::copy_whole(std::span<const std::span<const core::BodyId>> clusters) const {
  return std::move(copy(membership(clusters), clusters.size(), true).clusters);
}

core::ClusterState Simulation::release(std::span<const core::BodyId> bodies) {
  return std::move(release({&bodies, 1}).front());
}

std::vector<core::ClusterState> Simulation::release(std::span<const std::span<const core::BodyId>> clusters) {
  const std::vector<std::uint32_t> cluster_at = membership(clusters);
  Copies leaving = copy(cluster_at, clusters.size(), false);
  severed_contacts_ += leaving.across;
  std::vector<bool> leaves(table_.size());
  std::vector<btRigidBody*> born;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    leaves[i] = cluster_at[i] != kStays;
    if (leaves[i] && table_[i].born) born.push_back(table_[i].rigid.get());
  }
  for (const core::ClusterState& cluster : leaving.clusters) joints_.disconnect(cluster, table_, world_);
  core::Progress::mark();
  world_.remove(born);
  erase(leaves);
  return std::move(leaving.clusters);
}

}  // namespace aurasim::physics
