// Contacts as records of a cluster, in an order that does not depend on the past.
#pragma once

#include <vector>

#include "core/body_state.h"
#include "physics/contact_view.h"

namespace aurasim::physics {

/// A contact and its two objects.
struct KeyedContact {
  core::ObjectRef object0 = 0;
  core::ObjectRef object1 = 0;
  ContactView contact;
};

/// Sets the records of the cluster to those of the contacts, in the order of objects and parts. Sorts `contacts`, and
/// reuses the memory of the cluster.
void write_contacts(std::vector<KeyedContact>& contacts, core::ClusterState& cluster);

}  // namespace aurasim::physics
