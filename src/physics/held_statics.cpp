#include "physics/held_statics.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/keep_one_of_each.h"
#include "physics/bullet_convert.h"
#include "physics/construction.h"
#include "physics/inner_edges.h"
#include "physics/part_surfaces.h"
#include "physics/spare_memory.h"

namespace aurasim::physics {
namespace {

static_assert(HeldStatics::kNear_m >= InnerEdges::kReach_m && HeldStatics::kFar_m > HeldStatics::kNear_m);

/// drop_some() looks at each cell once in so many steps.
constexpr std::size_t kStepsOfRound = 128;
/// Memory is given back to the system after so many statics have gone.
constexpr std::size_t kManyStatics = 4096;

}  // namespace

HeldStatics::HeldStatics(const core::Scene& scene, std::shared_ptr<const ShapeSet> shapes,
                         std::shared_ptr<const StaticPlaces> places, DynamicsWorld& world)
    : scene_(scene),
      shapes_(std::move(shapes)),
      places_(std::move(places)),
      world_(world),
      is_held_(places_->cell_count(), false) {}

std::vector<Bounds> HeldStatics::show(const Timeline& timeline, core::Step n) {
  const auto first_new = static_cast<std::uint32_t>(size_), end = static_cast<std::uint32_t>(scene_.statics.size());
  if (std::exchange(has_shown_, true)) {
    for (std::uint32_t i = first_new; i < end; ++i) absent_.push_back(i);
  }
  size_ = end;
  std::vector<std::uint32_t> asked = timeline.changing_statics();
  std::ranges::copy(absent_, std::back_inserter(asked));
  core::keep_one_of_each(asked);
  std::vector<Bounds> changed;
  std::vector<std::uint32_t> absent;
  for (const std::uint32_t i : asked) {
    if (!timeline.stands(i, n)) absent.push_back(i);
    if (timeline.stands(i, n) == is_absent(i)) changed.push_back(bounds(i));
  }
  absent_ = std::move(absent);
  for (const std::uint32_t i : asked) {
    if (const auto known = held_.find(i); known != held_.end()) place(i, known->second);
  }
  for (const std::uint32_t i : places_->everywhere()) {
    if (i >= first_new) hold_always(i);
  }
  for (auto i = std::max(first_new, static_cast<std::uint32_t>(places_->size())); i < end; ++i) hold_always(i);
  return changed;
}

btRigidBody* HeldStatics::find(std::uint32_t index) const {
  const auto known = held_.find(index);
  return known != held_.end() ? known->second.object.get() : nullptr;
}

bool HeldStatics::is_in(std::uint32_t index) const {
  const auto known = held_.find(index);
  return known != held_.end() && known->second.is_in;
}

Bounds HeldStatics::bounds(std::uint32_t index) const {
  const auto known = held_.find(index);
  return known != held_.end() ? bounds_of(*known->second.object) : bounds_of_static(scene_, index, *shapes_);
}

bool HeldStatics::is_absent(std::uint32_t index) const { return std::ranges::binary_search(absent_, index); }

void HeldStatics::bring(std::span<const Bounds> places) {
  if (held_cells_.size() == places_->cell_count()) return;
  for (const Bounds& where : places) {
    places_->for_each_cell(where.grown(btScalar(kNear_m)), [this](std::uint32_t cell) { hold_cell(cell); });
  }
}

void HeldStatics::hold(std::uint32_t index) {
  if (held_.contains(index)) return;
  places_->for_each_cell(bounds_of_static(scene_, index, *shapes_), [this](std::uint32_t cell) { hold_cell(cell); });
}

btRigidBody& HeldStatics::hold_always(std::uint32_t index) {
  const auto known = held_.find(index);
  if (known != held_.end() && known->second.is_always) return *known->second.object;
  Held& held = need(index);
  held.is_always = true;
  return *held.object;
}

void HeldStatics::hold_cell(std::uint32_t cell) {
  if (is_held_[cell]) return;
  is_held_[cell] = true;
  held_cells_.push_back(cell);
  for (const std::uint32_t index : places_->in(cell)) need(index);
}

HeldStatics::Held& HeldStatics::need(std::uint32_t index) {
  Held& held = held_[index];
  ++held.needed_by;
  if (held.object != nullptr) return held;
  const core::StaticBody& body = scene_.statics[index];
  auto info = construction_of(0, shapes_->shape(body.shape), core::Vec3::Zero(), scene_.materials.at(body.material));
  info.m_startWorldTransform = to_bullet(body.pose);
  held.object = std::make_unique<btRigidBody>(info);
  held.object->setUserIndex(-1 - static_cast<int>(index));
  use_part_surfaces(*held.object);
  place(index, held);
  return held;
}

/// Puts a static into the Bullet world, or takes it out, as the state that is shown has it.
void HeldStatics::place(std::uint32_t index, Held& held) {
  const bool stands = !is_absent(index);
  if (stands == held.is_in) return;
  held.is_in = stands;
  btRigidBody* const object = held.object.get();
  if (stands) {
    world_.insert_static(*object, 1 + static_cast<int>(index), to_bullet(scene_.statics.pose(index)));
  } else {
    world_.remove_statics({&object, 1});
  }
}

bool HeldStatics::is_idle(std::uint32_t cell) const {
  return !world_.has_body_near(places_->bounds_of_cell(cell).grown(btScalar(kFar_m)));
}

void HeldStatics::drop_some() {
  const std::size_t count = held_cells_.empty() ? 0 : 1 + held_cells_.size() / kStepsOfRound;
  for (std::size_t i = 0; i < count; ++i) {
    if (next_ == held_cells_.size()) {
      drop_idle();
      next_ = 0;
      if (held_cells_.empty()) return;
    }
    const std::uint32_t cell = held_cells_[next_++];
    if (is_idle(cell)) idle_.push_back(cell);
  }
}

/// Lets go of the cells in idle_ that nothing has come near since. All at once, because the world walks over all pairs.
void HeldStatics::drop_idle() {
  std::vector<btRigidBody*> leaving;
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t cell : idle_) {
    if (!is_idle(cell)) continue;
    is_held_[cell] = false;
    for (const std::uint32_t index : places_->in(cell)) {
      Held& held = held_.at(index);
      if (--held.needed_by > 0) continue;
      if (held.is_in) leaving.push_back(held.object.get());
      numbers.push_back(index);
    }
  }
  idle_.clear();
  std::erase_if(held_cells_, [this](std::uint32_t cell) { return !is_held_[cell]; });
  if (!leaving.empty()) world_.remove_statics(leaving);
  for (const std::uint32_t index : numbers) held_.erase(index);
  freed_ += numbers.size();
  if (freed_ < kManyStatics) return;
  freed_ = 0;
  give_memory_back();
}

}  // namespace aurasim::physics
