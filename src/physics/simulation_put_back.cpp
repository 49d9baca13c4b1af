// Going back to an earlier state. To fill an empty world takes several times as long as a step, most of it for Bullet's
// tree of bounds and for memory. So bodies, pairs and joints of both states stay in Bullet's world, and get the state
// that they had. They keep nothing of the states between: the bits are those of a world made anew.
#include "core/progress.h"
#include "physics/simulation.h"

namespace aurasim::physics {

void Simulation::put_back(core::Step step, const core::ClusterState& then) {
  const std::vector<core::BodyRecord> arrivals = take_out_all_but(then.bodies, step);
  step_ = step;
  world_.forget_past();
  if (timeline_.statics_change()) show_statics(step);
  place_moving_statics();
  std::size_t near = 0;
  for (const core::BodyRecord& record : then.bodies) {
    HostedBody* const body = table_.find(record.id, near);
    if (body == nullptr) continue;
    body->epoch = record.epoch;
    body->birth = record.birth;
    set_motion(*body->rigid, record);
    world_.move(*body->rigid);
  }
  core::Progress::mark();
  put_in(arrivals);
  joints_.put_back(then, table_, world_);
  insert_born();
  restore_contacts(then);
  note_all();
}

/// Removes the bodies that are not among `bodies`, or are others there, or are born later than state `step`. Returns
/// the records of those that have to be added.
std::vector<core::BodyRecord> Simulation::take_out_all_but(std::span<const core::BodyRecord> bodies, core::Step step) {
  std::vector<core::BodyRecord> arrivals;
  std::vector<bool> leaves(table_.size(), true);
  std::size_t near = 0;
  for (const core::BodyRecord& record : bodies) {
    const HostedBody* const body = table_.find(record.id, near);
    const bool stays =
        body != nullptr && body->born && record.birth <= step && body->prototype == record.prototype && leaves[near];
    if (stays) {
      leaves[near] = false;
    } else {
      arrivals.push_back(record);
    }
  }
  core::ClusterState leaving;
  std::vector<std::uint32_t> places;
  std::vector<btRigidBody*> born;
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    if (!leaves[i]) continue;
    places.push_back(i);
    leaving.bodies.push_back({.id = table_[i].id});
    if (table_[i].born) born.push_back(table_[i].rigid.get());
  }
  if (leaving.bodies.empty()) return arrivals;
  joints_.disconnect(leaving, table_, world_);
  world_.remove(born);
  erase(places);
  return arrivals;
}

}  // namespace aurasim::physics
