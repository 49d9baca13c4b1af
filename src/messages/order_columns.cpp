#include "messages/order_columns.h"

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "aurasim.h"
#include "messages/bearable.h"
#include "messages/columns.h"

namespace aurasim::messages {

using core::Action;
using core::BodyId;
using core::StaticId;
using core::value_of;
using core::Vec3;

namespace {

constexpr std::size_t kMostOrders = 4096;
constexpr std::size_t kMostNumbers = 1 << 16;
constexpr std::size_t kMostTextOfRow = 1 << 16;
constexpr std::uint32_t kMostIndices = 1 << 20;
constexpr std::uint32_t kFirstMeshRow = 4;
constexpr auto kMostSubjects = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

struct Row {
  std::uint64_t subject = 0;
  std::uint32_t index = 0;
  std::vector<double> numbers;
  std::string text;
};

void put(Row& row, const Vec3& v) { row.numbers.insert(row.numbers.end(), {v.x(), v.y(), v.z()}); }

void put(Row& row, const core::Pose& pose) {
  put(row, pose.p_WB);
  const core::Quat& q = pose.q_WB;
  row.numbers.insert(row.numbers.end(), {q.w(), q.x(), q.y(), q.z()});
}

struct ShapeToRow {
  Row& row;
  void operator()(const core::Sphere& s) const { row.numbers = {s.radius}; }
  void operator()(const core::Box& s) const { put(row, s.half_extents); }
  void operator()(const core::Capsule& s) const { row.numbers = {s.radius, s.height}; }
  void operator()(const core::Cylinder& s) const { row.numbers = {s.radius, s.height}; }
  void operator()(const core::MeshRef& s) const {
    row.subject = s.hash;
    row.index = kFirstMeshRow + static_cast<std::uint32_t>(s.use);
  }
};

struct ToRow {
  Row& row;
  void operator()(const core::DefineShape& a) const {
    row.index = static_cast<std::uint32_t>(a.shape.index());
    std::visit(ShapeToRow{row}, a.shape);
  }
  void operator()(const core::DefinePrototype& a) const {
    row.index = a.shape;
    row.numbers = {a.mass_kg};
  }
  void operator()(const core::Spawn& a) const {
    row.subject = value_of(a.id);
    row.index = value_of(a.prototype);
    put(row, a.pose);
    put(row, a.v_WB);
    put(row, a.w_WB);
  }
  void operator()(const core::AddStatic& a) const {
    row.subject = value_of(a.id);
    row.index = a.shape;
    put(row, a.pose);
  }
  void operator()(const core::RemoveBody& a) const { row.subject = value_of(a.id); }
  void operator()(const core::RemoveStatic& a) const { row.subject = value_of(a.id); }
  void operator()(const core::MoveStatic& a) const {
    row.subject = value_of(a.id);
    row.index = static_cast<std::uint32_t>(a.states);
    put(row, a.from);
    put(row, a.to);
  }
  void operator()(const core::Impulse& a) const {
    row.subject = value_of(a.id);
    put(row, a.J_W);
    if (a.p_W) put(row, *a.p_W);
  }
  void operator()(const core::SetVelocity& a) const {
    row.subject = value_of(a.id);
    put(row, a.v_WB);
    if (a.w_WB) put(row, *a.w_WB);
  }
  void operator()(const core::Repartition& a) const {
    for (const core::Rectangle& r : a.boxes) row.numbers.insert(row.numbers.end(), {r.x0, r.y0, r.x1, r.y1});
  }
  void operator()(const core::ChangeScene& a) const { row.text = a.name; }
  void operator()(const core::Save& a) const { row.text = a.file; }
  void operator()(const core::Load& a) const { row.text = a.file; }
  void operator()(const core::Redo& a) const {
    row.numbers = {static_cast<double>(a.cut), static_cast<double>(a.confirmed), a.is_for_static ? 1.0 : 0.0};
    for (const core::TogetherPair& pair : a.pairs) {
      const std::array<double, 3> numbers = {static_cast<double>(value_of(pair.a)),
                                             static_cast<double>(value_of(pair.b)), static_cast<double>(pair.until)};
      row.numbers.insert(row.numbers.end(), numbers.begin(), numbers.end());
    }
  }
};

struct Numbers {
  std::span<const double> all;
  Vec3 vector(std::size_t first) const { return {all[first], all[first + 1], all[first + 2]}; }
  core::Pose pose() const { return {vector(0), core::Quat(all[3], all[4], all[5], all[6])}; }
  bool are_positive() const {
    return std::all_of(all.begin(), all.end(), [](double x) { return x > 0; });
  }
  bool have_rotation() const {
    const double norm = std::sqrt(all[3] * all[3] + all[4] * all[4] + all[5] * all[5] + all[6] * all[6]);
    return std::abs(norm - 1) < 1e-6;
  }
};

using Maybe = std::optional<Action>;

Maybe shape_of(const Row& row, const Numbers& n) {
  const std::size_t count = n.all.size();
  if (!n.are_positive()) return {};
  if (row.index == 0 && count == 1) return core::DefineShape{core::Sphere{n.all[0]}};
  if (row.index == 1 && count == 3) return core::DefineShape{core::Box{n.vector(0)}};
  if (row.index == 2 && count == 2) return core::DefineShape{core::Capsule{n.all[0], n.all[1]}};
  if (row.index == 3 && count == 2) return core::DefineShape{core::Cylinder{n.all[0], n.all[1]}};
  if (row.index < kFirstMeshRow || row.index > kFirstMeshRow + 2 || count != 0) return {};
  return core::DefineShape{core::MeshRef{row.subject, static_cast<core::MeshUse>(row.index - kFirstMeshRow)}};
}

Maybe spawn_of(const Row& row, const Numbers& n) {
  if (n.all.size() != 13 || !n.have_rotation()) return {};
  return core::Spawn{BodyId{row.subject}, core::PrototypeId{row.index}, n.pose(), n.vector(7), n.vector(10)};
}

Maybe move_of(const Row& row, const Numbers& n) {
  constexpr std::size_t kPose = 7;
  if (n.all.size() != 2 * kPose || row.index == 0) return {};
  const Numbers from{n.all.first(kPose)}, to{n.all.subspan(kPose)};
  if (!from.have_rotation() || !to.have_rotation()) return {};
  return core::MoveStatic{StaticId{static_cast<std::uint32_t>(row.subject)}, from.pose(), to.pose(), row.index};
}

Maybe regions_of(const Numbers& n) {
  if (n.all.empty() || n.all.size() % 4 != 0) return {};
  core::Repartition action;
  for (std::size_t i = 0; i < n.all.size(); i += 4) {
    action.boxes.push_back({n.all[i], n.all[i + 1], n.all[i + 2], n.all[i + 3]});
    if (!(action.boxes.back().x0 < action.boxes.back().x1) || !(action.boxes.back().y0 < action.boxes.back().y1)) {
      return {};
    }
  }
  return action;
}

/// Reads a redo. Steps and body ids must be whole numbers that a double represents exactly.
Maybe redo_of(const Numbers& n) {
  constexpr double kMostExact = 9007199254740992.0;  // 2^53
  const auto whole = [](double x) { return x >= 0 && x < kMostExact && std::floor(x) == x; };
  const bool has_all = !n.all.empty() && n.all.size() % 3 == 0;
  if (!has_all || !std::all_of(n.all.begin(), n.all.end(), whole) || n.all[2] > 1) return {};
  core::Redo action;
  action.cut = static_cast<core::Step>(n.all[0]);
  action.confirmed = static_cast<core::Step>(n.all[1]);
  action.is_for_static = n.all[2] > 0;
  for (std::size_t i = 3; i < n.all.size(); i += 3) {
    action.pairs.push_back({BodyId{static_cast<std::uint64_t>(n.all[i])},
                            BodyId{static_cast<std::uint64_t>(n.all[i + 1])}, static_cast<core::Step>(n.all[i + 2])});
    if (!(action.pairs.back().a < action.pairs.back().b)) return {};
  }
  return action;
}

std::optional<Vec3> second_vector(const Numbers& n) {
  return n.all.size() == 6 ? std::optional(n.vector(3)) : std::nullopt;
}

Maybe action_of(std::uint8_t kind, const Row& row) {
  const Numbers n{row.numbers};
  const std::size_t count = n.all.size();
  const bool finite = all_finite(row.numbers);
  const StaticId fixed{static_cast<std::uint32_t>(row.subject)};
  const bool about_a_mesh = kind == 0;
  if (!about_a_mesh && row.subject > kMostSubjects) return {};
  if (kind == 8) return regions_of(n);
  if (!finite) return {};
  constexpr std::uint8_t kRedo = 10;  // its numbers are states and ids
  if (kind != kRedo && !all_within(row.numbers, bearable::kLargestOfAnOrder)) return {};
  switch (kind) {
    case 0:
      return shape_of(row, n);
    case 1:
      return count == 1 && n.are_positive() ? Maybe(core::DefinePrototype{row.index, n.all[0]}) : Maybe();
    case 2:
      return spawn_of(row, n);
    case 3:
      return count == 7 && n.have_rotation() ? Maybe(core::AddStatic{fixed, row.index, n.pose()}) : Maybe();
    case 4:
      return count == 0 ? Maybe(core::RemoveBody{BodyId{row.subject}}) : Maybe();
    case 5:
      return count == 0 ? Maybe(core::RemoveStatic{fixed}) : Maybe();
    case 6:
      return count == 3 || count == 6 ? Maybe(core::Impulse{BodyId{row.subject}, n.vector(0), second_vector(n)})
                                      : Maybe();
    case 7:
      return count == 3 || count == 6 ? Maybe(core::SetVelocity{BodyId{row.subject}, n.vector(0), second_vector(n)})
                                      : Maybe();
    case 9:
      return count == 0 && !row.text.empty() ? Maybe(core::ChangeScene{row.text}) : Maybe();
    case 10:
      return redo_of(n);
    case 11:
      return count == 0 && !row.text.empty() ? Maybe(core::Save{row.text}) : Maybe();
    case 12:
      return count == 0 && !row.text.empty() ? Maybe(core::Load{row.text}) : Maybe();
    case 13:
      return move_of(row, n);
    default:
      return {};
  }
}

bool have_room(const wire::AuraBatch& in) {
  const std::size_t rows = in.order_sequence().size();
  return rows <= kMostOrders && in.order_numbers().size() <= kMostNumbers && in.order_text().size() <= kMostTextOfRow &&
         same_rows(rows, {{in.order_request().size()},
                          {in.order_step().size()},
                          {in.order_kind().size()},
                          {in.order_subject().size()},
                          {in.order_index().size()},
                          {in.order_number_count().size()}}) &&
         none_negative(in.order_step()) && all_below(in.order_index(), kMostIndices);
}

}  // namespace

void encode_orders(const std::vector<core::Order>& orders, wire::AuraBatch& out) {
  std::vector<Row> rows(orders.size());
  for (std::size_t i = 0; i < rows.size(); ++i) std::visit(ToRow{rows[i]}, orders[i].action);
  fill(out.order_sequence(), orders, [](const core::Order& o) { return o.sequence; });
  fill(out.order_request(), orders, [](const core::Order& o) { return o.request; });
  fill(out.order_step(), orders, [](const core::Order& o) { return o.at_step; });
  fill(out.order_kind(), orders, [](const core::Order& o) { return static_cast<std::uint8_t>(o.action.index()); });
  fill(out.order_subject(), rows, [](const Row& r) { return r.subject; });
  fill(out.order_index(), rows, [](const Row& r) { return r.index; });
  fill(out.order_number_count(), rows, [](const Row& r) { return static_cast<std::uint32_t>(r.numbers.size()); });
  out.order_numbers().clear();
  out.order_text().clear();
  for (const Row& row : rows) {
    out.order_numbers().insert(out.order_numbers().end(), row.numbers.begin(), row.numbers.end());
    out.order_text().insert(out.order_text().end(), row.text.begin(), row.text.end());
    out.order_text().push_back(0);
  }
}

std::optional<std::vector<core::Order>> decode_orders(const wire::AuraBatch& in) {
  if (!have_room(in)) return {};
  std::vector<core::Order> orders;
  auto number = in.order_numbers().begin();
  auto text = in.order_text().begin();
  for (std::size_t i = 0; i < in.order_sequence().size(); ++i) {
    const auto end = std::find(text, in.order_text().end(), 0);
    if (in.order_number_count()[i] > in.order_numbers().end() - number || end == in.order_text().end()) return {};
    Row row{in.order_subject()[i], in.order_index()[i], {number, number + in.order_number_count()[i]}, {text, end}};
    const Maybe action = action_of(in.order_kind()[i], row);
    if (!action) return {};
    orders.push_back({in.order_sequence()[i], in.order_request()[i], in.order_step()[i], *action});
    number += in.order_number_count()[i];
    text = end + 1;
  }
  return orders;
}

}  // namespace aurasim::messages
