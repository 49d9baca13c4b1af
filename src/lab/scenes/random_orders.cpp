#include "lab/scenes/random_orders.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/order.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

class OrderWriter {
 public:
  OrderWriter(const Kinds& kinds, const RandomLayout& layout, const Json& bodies, double speed_m_s, Chance& chance)
      : kinds_(kinds), layout_(layout), bodies_(bodies), speed_m_s_(speed_m_s), chance_(chance) {}

  Json next() {
    using Write = Json (OrderWriter::*)();
    constexpr std::array<Write, 8> kWriters = {&OrderWriter::spawn,    &OrderWriter::spawn,   &OrderWriter::spawn_own,
                                               &OrderWriter::remove,   &OrderWriter::impulse, &OrderWriter::impulse,
                                               &OrderWriter::velocity, &OrderWriter::wall};
    Json order = {{"at_step", kFirstOrder + chance_.below(kLastOrder - kFirstOrder)}};
    order.update((this->*kWriters[chance_.below(kWriters.size())])());
    return order;
  }

  /// Removes some of the walls that orders have added.
  void take_walls_down(Json& orders) {
    for (const std::string& name : walls_) {
      if (chance_.below(2) == 0) continue;
      orders.push_back({{"at_step", kLastOrder + chance_.below(20)}, {"remove_static", name}});
    }
  }

 private:
  Vec3 velocity_somewhere(double share) {
    const double most = share * speed_m_s_;
    const Vec3 v = {chance_.between(-0.6, 0.6), chance_.between(-0.6, 0.6), chance_.between(-0.2, 0.3)};
    return most * v;
  }
  Vec3 somewhere(double z) {
    const Vec3 spot = layout_.spots[chance_.below(static_cast<std::uint32_t>(layout_.spots.size()))];
    const Vec3 aside = {chance_.between(-0.3, 0.3), chance_.between(-0.3, 0.3), 0};
    return spot + std::min(layout_.half_x_m, layout_.half_y_m) * aside + Vec3(0, 0, z);
  }
  /// A body of the scene, or one that a client spawns. It may not exist yet, or not any more.
  const Json& any_body() {
    if (!spawned_.empty() && chance_.below(4) == 0) {
      return spawned_[chance_.below(static_cast<std::uint32_t>(spawned_.size()))];
    }
    return bodies_[chance_.below(static_cast<std::uint32_t>(bodies_.size()))];
  }
  double mass_of(const Json& body) const {
    if (!body.contains("prototype")) return body["mass"];
    const std::string name = body["prototype"];
    return std::ranges::find(kinds_.all, name, &Kind::name)->mass_kg;
  }

  Json put(Json what) {
    what["id"] = core::kFirstClientBody + spawned_.size() + 1;
    what["position"] = json_vec3(somewhere(chance_.between(1, 2.5)));
    what["velocity"] = json_vec3(velocity_somewhere(0.8));
    spawned_.push_back(what);
    return {{"spawn", std::move(what)}};
  }
  Json spawn() {
    const auto count = static_cast<std::uint32_t>(kinds_.all.size());
    return put({{"prototype", kinds_.all[chance_.below(count)].name}});
  }
  Json spawn_own() {
    const double size = rounded(chance_.between(0.1, 0.4));
    return put({{"sphere", {{"radius", size}}}, {"mass", rounded(chance_.between(0.05, 20))}});
  }
  Json remove() { return {{"remove_body", any_body()["id"]}}; }
  Json impulse() {
    const Json& body = any_body();
    return {{"impulse", {{"body", body["id"]}, {"value", json_vec3(mass_of(body) * velocity_somewhere(0.6))}}}};
  }
  Json velocity() {
    Json what = {{"body", any_body()["id"]}, {"value", json_vec3(velocity_somewhere(0.9))}};
    if (chance_.below(2) == 0) what["spin"] = {0, 0, rounded(chance_.between(-20, 20))};
    return {{"set_velocity", what}};
  }
  Json wall() {
    walls_.push_back(fmt::format("wall_{}", walls_.size()));
    const Vec3 size = {chance_.between(0.1, 1.5), chance_.between(0.1, 1.5), chance_.between(0.2, 1.5)};
    return {{"add_static",
             {{"name", walls_.back()},
              {"box", {{"size", json_vec3(size)}}},
              {"position", json_vec3(somewhere(0.5 * size.z()))}}}};
  }

  const Kinds& kinds_;
  const RandomLayout& layout_;
  const Json& bodies_;
  double speed_m_s_;
  Chance& chance_;
  std::vector<Json> spawned_;
  std::vector<std::string> walls_;
};

}  // namespace

Json random_interference(const Kinds& kinds, const RandomLayout& layout, const Json& scene, double speed_m_s,
                         Chance& chance) {
  Json orders = Json::array();
  if (chance.below(5) < 3) {
    OrderWriter writer(kinds, layout, scene["bodies"], speed_m_s, chance);
    for (std::uint32_t left = 3 + chance.below(15); left > 0; --left) orders.push_back(writer.next());
    writer.take_walls_down(orders);
  }
  // Two draws that are not used: a seed's world stays the one that it was with earlier versions.
  if (chance.below(2) != 0) chance.below(40);
  return {{"orders", std::move(orders)}};
}

}  // namespace aurasim::lab
