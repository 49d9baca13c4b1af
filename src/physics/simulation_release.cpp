// Release of bodies from a simulation, with everything that a hand-off has to carry.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/progress.h"
#include "physics/simulation.h"

namespace aurasim::physics {

/// The bodies of the clusters, ascending by place in the table.
std::vector<Simulation::Member> Simulation::membership(std::span<const std::span<const core::BodyId>> clusters) const {
  std::vector<Member> members;
  for (std::uint32_t cluster = 0; cluster < clusters.size(); ++cluster) {
    std::size_t near = 0;
    for (const core::BodyId id : clusters[cluster]) {
      if (table_.find(id, near) == nullptr) {
        throw std::invalid_argument("body " + std::to_string(core::value_of(id)) + " is not here");
      }
      members.push_back({static_cast<std::uint32_t>(near), cluster});
    }
  }
  std::ranges::sort(members, {}, &Member::place);
  return members;
}

struct Simulation::Copies {
  std::vector<core::ClusterState> clusters;
  std::uint64_t across = 0;  ///< contacts and joints with bodies outside the cluster
};

Simulation::Copies Simulation::copy(std::span<const Member> members, std::size_t count, bool whole) const {
  Copies copies;
  copies.clusters.resize(count);
  std::vector<const btRigidBody*> bodies;
  for (const Member& member : members) {
    copies.clusters[member.cluster].bodies.push_back(table_[member.place].record());
    bodies.push_back(table_[member.place].rigid.get());
  }
  std::vector<std::vector<KeyedContact>> contacts(count);
  world_.for_each_contact(bodies, [&](const ContactView& contact, std::size_t i0, std::size_t i1) {
    const KeyedContact keyed{ref_of(contact.body0()), ref_of(contact.body1()), contact};
    const bool one = i0 < members.size(), other = i1 < members.size();
    const bool has_static = contact.body0().isStaticObject() || contact.body1().isStaticObject();
    const bool is_inside = has_static || (one && other && members[i0].cluster == members[i1].cluster);
    if (!is_inside) ++copies.across;
    if (!is_inside && !whole) return;
    if (one) contacts[members[i0].cluster].push_back(keyed);
    if (other && !(one && is_inside)) contacts[members[i1].cluster].push_back(keyed);
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
  const std::vector<Member> members = membership(clusters);
  Copies leaving = copy(members, clusters.size(), false);
  severed_contacts_ += leaving.across;
  std::vector<std::uint32_t> places;
  std::vector<btRigidBody*> born;
  for (const Member& member : members) {
    places.push_back(member.place);
    if (table_[member.place].born) born.push_back(table_[member.place].rigid.get());
  }
  for (const core::ClusterState& cluster : leaving.clusters) joints_.disconnect(cluster, table_, world_);
  core::Progress::mark();
  world_.remove(born);
  erase(places);
  return std::move(leaving.clusters);
}

}  // namespace aurasim::physics
