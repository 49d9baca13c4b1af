#include "core/world_cut.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <tuple>

#include "core/keep_one_of_each.h"
#include "core/united.h"

namespace aurasim::core {
namespace {

/// Unites the orders of several regions. Each region knows a beginning of the same sequence, with the same orders left
/// out.
void append(std::vector<Order>& to, const std::vector<Order>& from) {
  to.insert(to.end(), from.begin(), from.end());
  keep_one_of_each(to, &Order::sequence);
}

void append(std::vector<SavedShape>& to, const std::vector<SavedShape>& from) {
  for (const SavedShape& shape : from) {
    if (std::ranges::find(to, shape.mesh, &SavedShape::mesh) == to.end()) to.push_back(shape);
  }
}

void append(std::vector<SavedMesh>& to, std::vector<SavedMesh> from) {
  for (SavedMesh& mesh : from) {
    if (std::ranges::find(to, mesh.hash, &SavedMesh::hash) == to.end()) to.push_back(std::move(mesh));
  }
}

/// Unites the setpoints of several nodes, which all receive the same messages. A message may be late on one node and in
/// time on another, so at_step may differ.
void append(std::vector<Setpoints>& to, const std::vector<Setpoints>& from) {
  const auto place = [](const Setpoints& one) { return std::tuple(one.client, one.sequence, one.at_step); };
  to.insert(to.end(), from.begin(), from.end());
  std::ranges::stable_sort(to, {}, place);
  const auto is_said = [&](const Setpoints& one, const Setpoints& other) {
    return one.client == other.client && one.sequence == other.sequence &&
           (one.sequence != 0 || one.at_step == other.at_step);
  };
  const auto copies = std::ranges::unique(to, is_said);
  to.erase(copies.begin(), copies.end());
}

void refuse_twins(const WorldCut& cut) {
  std::vector<BodyId> ids;
  for (const BodyRecord& body : cut.bodies.bodies) ids.push_back(body.id);
  for (const UnderWay& one : cut.under_way) {
    for (const BodyRecord& body : one.cluster.bodies) ids.push_back(body.id);
  }
  std::ranges::sort(ids);
  const auto twin = std::ranges::adjacent_find(ids);
  if (twin == ids.end()) return;
  throw std::invalid_argument("body " + std::to_string(value_of(*twin)) + " is in two of the parts");
}

}  // namespace

WorldCut merge(std::vector<WorldCut> parts) {
  if (parts.empty()) throw std::invalid_argument("there are no parts");
  WorldCut whole = std::move(parts.front());
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) {
    if (part->step != whole.step || part->births_known != whole.births_known) {
      throw std::invalid_argument("parts of states " + std::to_string(whole.step) + " and " +
                                  std::to_string(part->step) + " are not of one world");
    }
    append(whole.bodies, part->bodies);
    std::ranges::move(part->under_way, std::back_inserter(whole.under_way));
    append(whole.orders, part->orders);
    append(whole.shapes, part->shapes);
    append(whole.meshes, std::move(part->meshes));
    append(whole.setpoints, part->setpoints);
    whole.last_order = std::max(whole.last_order, part->last_order);
  }
  put_in_order(whole.bodies);
  refuse_twins(whole);
  return whole;
}

std::size_t body_count(const WorldCut& cut) {
  std::size_t count = cut.bodies.bodies.size();
  for (const UnderWay& one : cut.under_way) count += one.cluster.bodies.size();
  return count;
}

}  // namespace aurasim::core
