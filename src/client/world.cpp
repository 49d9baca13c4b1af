#include <utility>

#include <aurasim/client.h>

#include "client/answers.h"
#include "client/asks.h"
#include "client/connection.h"
#include "client/observation.h"
#include "client/program_file.h"

namespace aurasim::client {
namespace {

using nlohmann::json;

/// Row i of an array of n x 3.
Vec3 row(const std::vector<double>& array, std::size_t i) { return {array[3 * i], array[3 * i + 1], array[3 * i + 2]}; }

void check_rows(std::size_t bodies, std::size_t numbers) {
  if (numbers != 3 * bodies) {
    throw Error("found " + std::to_string(bodies) + " bodies and " + std::to_string(numbers) +
                " numbers, allowed: three for each body");
  }
}

}  // namespace

struct World::Impl {
  Impl(const std::string& program, const std::string& log, std::function<bool()> interrupted)
      : connection(program_file(program), log, std::move(interrupted)) {}

  json ask(json head, Seconds time_out) { return connection.ask({std::move(head), {}}, time_out).head; }
  Bodies ask_bodies(json head, Seconds time_out) { return bodies_of(connection.ask({std::move(head), {}}, time_out)); }

  /// Asks the run for one thing.
  Message ask_run(json ask, Seconds time_out) {
    return connection.ask({{{"do", "ask"}, {"asks", json::array({std::move(ask)})}}, {}}, time_out);
  }
  /// Requests several acts at once. Returns their results in the same order.
  std::vector<Acknowledgement> act(json asks, std::int64_t at_step, Seconds time_out) {
    for (json& one : asks) {
      if (at_step != 0) one["at"] = at_step;
    }
    const json head = ask({{"do", "ask"}, {"asks", std::move(asks)}}, time_out);
    std::vector<Acknowledgement> done;
    std::string refused;
    for (const json& one : head.value("acts", json::array())) {
      if (one.contains("refused") && refused.empty()) refused = one.value("refused", "");
      done.push_back(acknowledgement_of(one));
    }
    if (!refused.empty()) throw Refused(refused);
    return done;
  }
  Acknowledgement act_one(json ask, std::int64_t at_step, Seconds time_out) {
    const std::vector<Acknowledgement> done = act(json::array({std::move(ask)}), at_step, time_out);
    if (done.empty()) throw Error("the agent has not answered");
    return done.front();
  }

  Connection connection;
};

Shape Shape::sphere(double radius_m) { return {.kind = Kind::kSphere, .radius_m = radius_m}; }
Shape Shape::box(const Vec3& size) { return {.kind = Kind::kBox, .size = size}; }
Shape Shape::capsule(double radius_m, double height_m) {
  return {.kind = Kind::kCapsule, .radius_m = radius_m, .height_m = height_m};
}
Shape Shape::mesh(std::string file, bool in_parts) {
  return {.kind = Kind::kMesh, .file = std::move(file), .in_parts = in_parts};
}

World::World(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

World::~World() {
  if (impl_) close();
}

World World::connect(const std::string& file, const ConnectOptions& options) {
  World world(std::make_shared<Impl>(options.program, options.log, options.interrupted));
  world.impl_->ask(
      {{"do", "connect"}, {"protocol", kAgentProtocol}, {"file", file}, {"set", options.overrides}, {"as", options.as}},
      options.time_out);
  return world;
}

World World::launch(const std::string& file, const LaunchOptions& options) {
  World world(std::make_shared<Impl>(options.program, options.log, options.interrupted));
  const json begun = world.impl_->ask({{"do", "launch"},
                                       {"protocol", kAgentProtocol},
                                       {"file", file},
                                       {"set", options.overrides},
                                       {"as", options.as},
                                       {"paused", options.paused},
                                       {"load", options.load},
                                       {"report", options.report},
                                       {"saves", options.saves},
                                       {"spares", options.spares}},
                                      options.time_out);
  world.impl_->connection.watch_launcher(begun.value("launcher", 0));
  return world;
}

int World::close(Seconds time_out) { return impl_->connection.close(time_out); }
bool World::closed() const { return !impl_->connection.is_open(); }
int World::agent_pid() const { return impl_->connection.pid(); }

RunInfo World::info(Seconds time_out) { return info_of(impl_->ask({{"do", "info"}}, time_out)); }
std::vector<NodeStatus> World::nodes(Seconds time_out) { return nodes_of(impl_->ask({{"do", "nodes"}}, time_out)); }
Bodies World::bodies(Seconds time_out) { return impl_->ask_bodies({{"do", "bodies"}}, time_out); }
RayHit World::ray(const Vec3& from, const Vec3& to, Seconds time_out) {
  return ray_hit_of(impl_->ask_run({{"kind", "ray"}, {"from", from}, {"to", to}}, time_out).head);
}

struct Observer::Impl {
  std::weak_ptr<World::Impl> world;
  std::uint64_t number = 0;
};

Observer::Observer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Observer::Observer(Observer&&) noexcept = default;
Observer& Observer::operator=(Observer&& other) noexcept {
  std::swap(impl_, other.impl_);
  return *this;
}

Observer::~Observer() {
  try {
    if (impl_) close();
  } catch (const std::exception&) {  // the world has ended, and the observation with it
  }
}

Observation Observer::next(Seconds time_out) {
  const auto world = impl_ ? impl_->world.lock() : nullptr;
  if (!world) throw Ended("this observer was closed, or its World");
  return observation_of(world->connection.ask({{{"do", "next"}, {"observer", impl_->number}}, {}}, time_out));
}

void Observer::close() {
  const auto world = impl_ ? impl_->world.lock() : nullptr;
  const std::uint64_t number = impl_ ? impl_->number : 0;
  impl_.reset();
  if (world && world->connection.is_open()) {
    world->ask({{"do", "end_observer"}, {"observer", number}}, Seconds{10});
  }
}

Observer World::observe(const Interest& interest, Seconds time_out) {
  const json begun = impl_->ask(interest_json(interest), time_out);
  return Observer(std::make_unique<Observer::Impl>(impl_, begun.value("observer", std::uint64_t{0})));
}

Bodies World::pause(Seconds time_out) { return bodies_of(impl_->ask_run(ask_json("pause"), time_out)); }
Bodies World::step(std::int64_t count, Seconds time_out) {
  return bodies_of(impl_->ask_run({{"kind", "step"}, {"count", count}}, time_out));
}
void World::resume(Seconds time_out) { impl_->ask_run(ask_json("resume"), time_out); }
void World::reset(Seconds time_out) { impl_->ask_run(ask_json("reset"), time_out); }
void World::stop(Seconds time_out) { impl_->ask_run(ask_json("stop"), time_out); }
Acknowledgement World::set_rate(double rate, Seconds time_out) {
  return impl_->act_one({{"kind", "rate"}, {"value", rate}}, 0, time_out);
}
Acknowledgement World::set_scene(const std::string& name, Seconds time_out) {
  return impl_->act_one({{"kind", "scene"}, {"name", name}}, 0, time_out);
}
Acknowledgement World::set_regions(const std::vector<std::array<double, 4>>& boxes, Seconds time_out) {
  return impl_->act_one(regions_json(boxes), 0, time_out);
}
std::uint32_t World::drain(std::uint32_t region, Seconds time_out) {
  return impl_->ask_run({{"kind", "drain"}, {"region", region}}, time_out).head.value("pid", 0U);
}

SavedWorld World::save(const std::string& name, Seconds time_out) {
  return saved_world_of(impl_->ask_run({{"kind", "save"}, {"name", name}}, time_out).head);
}
Acknowledgement World::load(const std::string& name, Seconds time_out) {
  return impl_->act_one({{"kind", "load"}, {"name", name}}, 0, time_out);
}
Acknowledgement World::back(Seconds time_out) { return impl_->act_one(ask_json("back"), 0, time_out); }

Acknowledgement World::spawn(const NewBody& body, std::int64_t at_step, Seconds time_out) {
  return impl_->act_one(spawn_json(body), at_step, time_out);
}
Acknowledgement World::add_static(const NewStatic& fixed, std::int64_t at_step, Seconds time_out) {
  return impl_->act_one(static_json(fixed), at_step, time_out);
}
Acknowledgement World::remove_body(std::uint64_t body, std::int64_t at_step, Seconds time_out) {
  return impl_->act_one({{"kind", "remove"}, {"body", body}}, at_step, time_out);
}
Acknowledgement World::remove_static(std::uint32_t fixed, std::int64_t at_step, Seconds time_out) {
  return impl_->act_one({{"kind", "remove"}, {"static", fixed}}, at_step, time_out);
}
Acknowledgement World::move_static(const std::variant<std::uint32_t, std::string>& fixed, const Vec3& position,
                                   const Quaternion& rotation, double duration, std::int64_t at_step,
                                   Seconds time_out) {
  return impl_->act_one(move_json(fixed, position, rotation, duration), at_step, time_out);
}
Acknowledgement World::impulse(std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point,
                               std::int64_t at_step, Seconds time_out) {
  return impl_->act_one(impulse_json(body, impulse, point), at_step, time_out);
}
Acknowledgement World::set_velocity(std::uint64_t body, const Vec3& linear, const std::optional<Vec3>& angular,
                                    std::int64_t at_step, Seconds time_out) {
  return impl_->act_one(velocity_json(body, linear, angular), at_step, time_out);
}

std::vector<Acknowledgement> World::impulses(const std::vector<std::uint64_t>& bodies,
                                             const std::vector<double>& impulses, std::int64_t at_step,
                                             Seconds time_out) {
  check_rows(bodies.size(), impulses.size());
  json asks = json::array();
  for (std::size_t i = 0; i < bodies.size(); ++i) asks.push_back(impulse_json(bodies[i], row(impulses, i), {}));
  return impl_->act(std::move(asks), at_step, time_out);
}

std::vector<Acknowledgement> World::set_velocities(const std::vector<std::uint64_t>& bodies,
                                                   const std::vector<double>& linear, std::int64_t at_step,
                                                   Seconds time_out) {
  check_rows(bodies.size(), linear.size());
  json asks = json::array();
  for (std::size_t i = 0; i < bodies.size(); ++i) asks.push_back(velocity_json(bodies[i], row(linear, i), {}));
  return impl_->act(std::move(asks), at_step, time_out);
}

std::int64_t World::control(const Control& control, std::int64_t at_step, Seconds time_out) {
  Message message;
  message.head = {{"do", "control"}, {"at", at_step}};
  const auto add = [&message](const auto& array) {
    message.body.append(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0]));
  };
  const std::pair<const char*, const BodyVectors*> lists[] = {{"forces", &control.forces},
                                                              {"torques", &control.torques},
                                                              {"velocities", &control.velocities},
                                                              {"spins", &control.spins}};
  for (const auto& [name, list] : lists) {
    if (!list->values.empty()) check_rows(list->bodies.size(), list->values.size());
    message.head[name] = {list->bodies.size(), !list->values.empty()};
    add(list->bodies), add(list->values);
  }
  const JointDrives& drives = control.drives;
  if (!drives.drives.empty() && drives.drives.size() != drives.joints.size()) {
    throw Error("found " + std::to_string(drives.joints.size()) + " joints and " +
                std::to_string(drives.drives.size()) + " drives, allowed: one for each joint, or none");
  }
  message.head["drives"] = {drives.joints.size(), !drives.drives.empty()};
  add(drives.joints);
  static_assert(sizeof(JointDrive) == 6 * sizeof(double));
  add(drives.drives);
  for (const StaticGoal& goal : control.statics) {
    json& of = message.head["statics"].emplace_back();
    of = {{"p", goal.position}, {"q", goal.rotation}, {"states", goal.states}};
    std::visit([&of](const auto& named) { of["static"] = named; }, goal.fixed);
  }
  return impl_->connection.ask(std::move(message), time_out).head.value("step", std::int64_t{0});
}

const char* version() { return AURASIM_VERSION; }

}  // namespace aurasim::client
