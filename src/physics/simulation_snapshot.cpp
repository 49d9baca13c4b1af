// What a simulation shows of its bodies: snapshots and records. Only bodies that have changed are looked at anew.
#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

#include "core/find_ascending.h"
#include "core/keep_one_of_each.h"
#include "core/progress.h"
#include "core/regroup.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// Room for so many bodies is never given back.
constexpr std::size_t kFewBodies = 1024;
/// In place of the place of a guest.
constexpr std::uint32_t kNotShown = std::numeric_limits<std::uint32_t>::max();

/// A body of which the snapshot has no state yet.
core::BodyState not_yet_there() {
  core::BodyState state;
  state.birth = std::numeric_limits<core::Step>::max();
  return state;
}

bool before(const core::Contact& x, const core::Contact& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); }
bool same(const core::Contact& x, const core::Contact& y) { return x.a == y.a && x.b == y.b; }

}  // namespace

/// A body's pose, velocity, activation state or block may have changed.
void Simulation::note(core::BodyId id) {
  notes_.note(id);
  findings_.forget();
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

/// A body has come, or has been born.
void Simulation::note_new(core::BodyId id) {
  notes_.note_new(id);
  findings_.forget();
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

void Simulation::note_all() {
  notes_.note_all();
  findings_.forget();
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

/// Takes bodies out of the table, by place, ascending. They have left Bullet's world already.
void Simulation::erase(std::span<const std::uint32_t> leaving) {
  forget_moved();
  findings_.forget();
  for (const std::uint32_t place : leaving) {
    hash_.drop(table_[place]);
    notes_.note_gone(table_[place].id);
  }
  table_.erase(leaving);
  snapshot_is_fresh_ = records_are_fresh_ = false;
}

double Simulation::bounding_radius(const HostedBody& body) const {
  return core::bounding_radius(scene_->shapes.at(scene_->prototypes.at(core::value_of(body.prototype)).shape).shape);
}

/// Upper bound of how much orders, setpoints and moving statics that are still to come will change the velocity of the
/// body's surface beyond its predicted path, m/s.
double Simulation::kick_ahead(const HostedBody& body, std::size_t place, std::span<const std::uint32_t> coming_statics,
                              std::span<const PlacedPush> pushes, std::span<const Shove> shoves) const {
  double kick = coming_kick(body, coming_statics);
  const auto push = std::ranges::lower_bound(pushes, place, {}, &PlacedPush::place);
  if (push != pushes.end() && push->place == place) kick += push->change_m_s;
  return kick + coming_shove(body, shoves);
}

const core::Snapshot& Simulation::snapshot() {
  if (snapshot_is_fresh_) return snapshot_;
  ChangedBodies& changed = notes_.for_snapshot;
  const std::vector<std::uint32_t> coming_statics = timeline_.statics_coming(step_);
  note_moving_statics();
  const std::vector<Shove> shoves = coming_shoves();
  const std::vector<PlacedPush> pushes = coming_pushes();
  for (const core::BodyId id : kicked_) changed.note(id);
  for (const core::Order& order : timeline_.coming(step_)) {
    if (const std::optional<core::BodyId> id = core::body_of(order.action)) changed.note(*id);
  }
  for (const PlacedPush& push : pushes) changed.note(table_[push.place].id);
  for (const std::uint32_t index : coming_statics) note_near(statics_.bounds(index));
  for (const Shove& shove : shoves) note_near(shove.where);
  if (!shoves.empty() && !changed.all()) {  // bodies that move may come to where a static pushes
    for (const std::uint32_t shown : snapshot_.changed) changed.note(snapshot_.bodies[shown].id);
  }

  const bool is_known = !changed.all() && snapshot_.number > 0;
  const bool others = std::exchange(notes_.others, false) && is_known && regroup_snapshot();
  snapshot_.goes_on = is_known && !others;
  ++snapshot_.number;
  snapshot_.changed.clear();
  snapshot_.changed_contacts.clear();
  kicked_.clear();
  if (!is_known) {
    snapshot_.born = snapshot_.awake = 0;
    snapshot_.bodies.clear();
    find_shown();
    if (snapshot_.bodies.capacity() > kFewBodies + 2 * shown_) snapshot_.bodies = {};
    snapshot_.bodies.resize(shown_, not_yet_there());
  }
  changed.for_each(table_, [&](const HostedBody& body, std::size_t place) {
    const std::uint32_t shown = shown_at(place);
    if (shown == kNotShown) return;
    const double kick = kick_ahead(body, place, coming_statics, pushes, shoves);
    if (snapshot_.goes_on) snapshot_.changed.push_back(shown);
    if (kick > 0 || !body.born) kicked_.push_back(body.id);
    show_state(body, shown, kick);
  });
  changed.clear();
  notes_.came.clear();
  snapshot_.step = step_;
  if (is_known) {
    list_changed_contacts();
  } else {
    list_contacts();
    leave_out_guests(snapshot_.contacts);
  }
  if (!snapshot_.goes_on) {
    joints_.list_pairs(table_, snapshot_.joints);
    leave_out_guests(snapshot_.joints);
  }
  steps_since_snapshot_ = 0;
  moved_.clear();
  moved_contacts_.clear();
  snapshot_is_fresh_ = true;
  return snapshot_;
}

/// Lays out a snapshot of all bodies but guests.
void Simulation::find_shown() {
  shown_at_.clear();
  shown_ = static_cast<std::uint32_t>(table_.size());
  if (coupling_ == nullptr) return;
  shown_ = 0;
  for (const HostedBody& body : table_.bodies()) shown_at_.push_back(body.is_guest ? kNotShown : shown_++);
}

/// The places in moved_ and moved_contacts_ are no longer those of the table.
void Simulation::forget_moved() {
  if (!moved_.empty()) notes_.for_snapshot.note_all();
}

/// Brings the places of the snapshot's bodies up to date after bodies have come or gone. States and contacts of the
/// others stay. Returns false if only guests have come and gone.
bool Simulation::regroup_snapshot() {
  find_shown();
  const bool any_came = list_contacts_of_arrivals();
  std::vector<core::BodyState>& bodies = snapshot_.bodies;
  std::vector<std::uint32_t> gone, came;
  std::vector<core::BodyId> ids_of_came;
  std::size_t near = 0, place = 0;
  const auto place_of = [&](core::BodyId id) {
    place = core::find_ascending(bodies, id, &core::BodyState::id, place);
    return static_cast<std::uint32_t>(place);
  };
  for (const core::BodyId id : notes_.for_snapshot.ids()) {
    const std::uint32_t before = place_of(id);
    const bool was = before < bodies.size() && bodies[before].id == id;
    const HostedBody* const body = table_.find(id, near);
    const bool is = body != nullptr && !body->is_guest;
    if (is && !was) ids_of_came.push_back(id);
    if (is || !was) continue;
    gone.push_back(before);
    if (bodies[before].birth <= snapshot_.step) count(bodies[before], -1);
  }
  if (gone.empty() && ids_of_came.empty()) return any_came;
  for (const core::BodyId id : ids_of_came) {
    const auto gone_before = std::ranges::lower_bound(gone, place_of(id)) - gone.begin();
    came.push_back(static_cast<std::uint32_t>(place_of(id) - gone_before + came.size()));
  }
  const std::vector<std::uint32_t> now_at = core::indices_after(bodies.size(), gone, came);
  core::regroup(bodies, gone, came, not_yet_there());
  for (std::size_t i = 0; i < came.size(); ++i) bodies[came[i]].id = ids_of_came[i];
  for (core::Contact& pair : snapshot_.contacts) pair = {now_at[pair.a], now_at[pair.b]};
  std::erase_if(snapshot_.contacts,
                [](const core::Contact& pair) { return pair.a == core::kGone || pair.b == core::kGone; });
  return true;
}

/// Notes the contacts of the bodies that have come or been born. They may have come with contacts, and sleep. Returns
/// false if there are none but guests.
bool Simulation::list_contacts_of_arrivals() {
  core::keep_one_of_each(notes_.came);
  std::vector<const btRigidBody*> bodies;
  for (const core::BodyId id : notes_.came) {
    const HostedBody* const body = table_.find(id);
    if (body == nullptr || body->is_guest) continue;
    bodies.push_back(body->rigid.get());
    moved_.push_back(static_cast<std::uint32_t>(bodies.back()->getUserIndex()));
  }
  if (bodies.empty()) return false;
  world_.for_each_contact(bodies, [this](const ContactView& contact, std::size_t, std::size_t) {
    const auto [a, b] = std::minmax({contact.body0().getUserIndex(), contact.body1().getUserIndex()});
    if (!is_static(a)) moved_contacts_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
  });
  return true;
}

/// Turns places in the table into places in the snapshot. Pairs with a guest are left out.
void Simulation::leave_out_guests(std::vector<core::Contact>& pairs) const {
  if (shown_at_.empty()) return;
  for (core::Contact& pair : pairs) pair = {shown_at(pair.a), shown_at(pair.b)};
  std::erase_if(pairs, [](const core::Contact& pair) { return pair.a == kNotShown || pair.b == kNotShown; });
}

/// Writes a body's state to its place in the snapshot, and counts it.
void Simulation::show_state(const HostedBody& body, std::size_t place, double coming_kick_m_s) {
  core::BodyState& state = snapshot_.bodies[place];
  if (state.birth <= snapshot_.step) count(state, -1);  // in the snapshot before, whose step is still here
  state = body.state();
  state.coming_kick_m_s = coming_kick_m_s;
  state.awake = state.awake || coming_kick_m_s > 0;
  if (body.born) count(state, 1);
}

void Simulation::count(const core::BodyState& state, std::int64_t times) {
  snapshot_.born = static_cast<std::size_t>(static_cast<std::int64_t>(snapshot_.born) + times);
  if (state.awake) snapshot_.awake = static_cast<std::size_t>(static_cast<std::int64_t>(snapshot_.awake) + times);
}

/// Lists the contacts of the snapshot in order. Uses a counting sort, because manifolds come in no order and each body
/// has several.
void Simulation::list_contacts() {
  unsorted_contacts_.clear();
  contacts_before_.assign(table_.size() + 1, 0);
  world_.for_each_contact([this](const ContactView& contact) {
    const auto [a, b] = std::minmax({contact.body0().getUserIndex(), contact.body1().getUserIndex()});
    if (is_static(a)) return;  // no test of distance: gaps of points never exceed kContactMargin
    unsorted_contacts_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    ++contacts_before_[static_cast<std::size_t>(a) + 1];
  });
  for (std::size_t i = 1; i < contacts_before_.size(); ++i) contacts_before_[i] += contacts_before_[i - 1];

  std::vector<core::Contact>& contacts = snapshot_.contacts;
  contacts.resize(unsorted_contacts_.size());
  for (const core::Contact& contact : unsorted_contacts_) contacts[contacts_before_[contact.a]++] = contact;
  std::size_t first = 0;
  // each entry of contacts_before_ is now the end of its body's contacts
  for (std::size_t a = 0; a < table_.size(); ++a) {
    const auto of_body = std::span(contacts).subspan(first, contacts_before_[a] - first);
    std::sort(of_body.begin(), of_body.end(), [](const auto& x, const auto& y) { return x.b < y.b; });
    first = contacts_before_[a];
  }
  core::Progress::mark();
  contacts.erase(std::unique(contacts.begin(), contacts.end(), same), contacts.end());
}

/// Replaces the contacts of the bodies that have moved. Those of other bodies are as they were.
void Simulation::list_changed_contacts() {
  std::vector<core::Contact>& changed = snapshot_.changed_contacts;
  leave_out_guests(moved_contacts_);
  for (std::uint32_t& place : moved_) place = shown_at(place);
  std::erase(moved_, kNotShown);
  std::ranges::sort(moved_contacts_, before);
  std::ranges::unique_copy(moved_contacts_, std::back_inserter(changed), same);
  is_moved_.resize(table_.size());
  for (const std::uint32_t place : moved_) is_moved_[place] = 1;
  const auto has_moved = [this](const core::Contact& contact) { return is_moved_[contact.a] || is_moved_[contact.b]; };
  unsorted_contacts_.clear();
  std::ranges::copy_if(snapshot_.contacts, std::back_inserter(unsorted_contacts_), has_moved);
  if (!std::ranges::equal(unsorted_contacts_, changed, same)) {
    unsorted_contacts_.clear();
    auto next = changed.begin();
    for (const core::Contact& contact : snapshot_.contacts) {
      if (has_moved(contact)) continue;
      while (next != changed.end() && before(*next, contact)) unsorted_contacts_.push_back(*next++);
      unsorted_contacts_.push_back(contact);
    }
    unsorted_contacts_.insert(unsorted_contacts_.end(), next, changed.end());
    std::swap(snapshot_.contacts, unsorted_contacts_);
  }
  for (const std::uint32_t place : moved_) is_moved_[place] = 0;
}

std::span<const core::BodyRecord> Simulation::records() {
  if (!records_are_fresh_) {
    records_.clear();
    for (const HostedBody& body : table_.bodies()) {
      if (body.born && !is_guest(*body.rigid)) records_.push_back(body.record());
    }
    records_are_fresh_ = true;
  }
  return records_;
}

}  // namespace aurasim::physics
