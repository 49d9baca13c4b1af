// The client library as the Python module aurasim._aurasim; aurasim/__init__.py puts its face on.
#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aurasim/client.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/values.h"

namespace py = pybind11;

namespace aurasim::client {
namespace {

/// Ctrl-C while a call waits. The error that Python has set then is the one that is thrown.
bool python_wants_to_stop() {
  const py::gil_scoped_acquire hold;
  return PyErr_CheckSignals() != 0;
}

/// Calls of several Python threads come one after the other.
class SharedWorld {
 public:
  explicit SharedWorld(World world) : world_(std::move(world)) {}

  template <class Call>
  auto with(Call&& call) {
    const py::gil_scoped_release others_run;
    const std::lock_guard lock(mutex_);
    return call(world_);
  }

 private:
  std::mutex mutex_;
  World world_;
};

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Ids = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>;

std::vector<double> rows_of(const Ids& ids, const Rows& rows) {
  if (ids.ndim() != 1 || rows.ndim() != 2 || rows.shape(0) != ids.shape(0) || rows.shape(1) != 3) {
    throw py::value_error("allowed: n ids, and an array of n x 3");
  }
  return {rows.data(), rows.data() + rows.size()};
}

std::vector<std::uint64_t> ids_of(const Ids& ids) { return {ids.data(), ids.data() + ids.size()}; }

using PyWorld = py::class_<SharedWorld, std::shared_ptr<SharedWorld>>;

void add_opening(PyWorld& world) {
  world.def_static("connect",
                   [](const std::string& file, const std::vector<std::string>& overrides, const std::string& as,
                      const std::string& program, const std::string& log, double timeout) {
                     const py::gil_scoped_release others_run;
                     return std::make_shared<SharedWorld>(
                         World::connect(file, {overrides, as, Seconds(timeout), program, log, python_wants_to_stop}));
                   });
  world.def_static("launch", [](const std::string& file, const std::vector<std::string>& overrides,
                                const std::string& as, const std::string& program, const std::string& log,
                                double timeout, bool paused, const std::string& load, const std::string& report,
                                const std::string& saves, int spares) {
    const py::gil_scoped_release others_run;
    return std::make_shared<SharedWorld>(World::launch(
        file,
        {overrides, as, Seconds(timeout), program, log, python_wants_to_stop, paused, load, report, saves, spares}));
  });
  world.def("close", [](SharedWorld& w, double t) { return w.with([=](World& o) { return o.close(Seconds(t)); }); });
  world.def("closed", [](SharedWorld& w) { return w.with([](World& o) { return o.closed(); }); });
  world.def("agent_pid", [](SharedWorld& w) { return w.with([](World& o) { return o.agent_pid(); }); });
}

std::shared_ptr<Bodies> shared(Bodies bodies) { return std::make_shared<Bodies>(std::move(bodies)); }

void add_sensing(PyWorld& world) {
  world.def("info", [](SharedWorld& w, double t) { return w.with([=](World& o) { return o.info(Seconds(t)); }); });
  world.def("nodes", [](SharedWorld& w, double t) { return w.with([=](World& o) { return o.nodes(Seconds(t)); }); });
  world.def("bodies",
            [](SharedWorld& w, double t) { return w.with([=](World& o) { return shared(o.bodies(Seconds(t))); }); });
  world.def("ray", [](SharedWorld& w, const Vec3& from, const Vec3& to, double t) {
    return w.with([&](World& o) { return o.ray(from, to, Seconds(t)); });
  });
}

Mount mount_of(const std::optional<std::uint64_t>& body, const Vec3& position, const Quaternion& rotation) {
  return {body, position, rotation};
}

/// Keeps the World: its calls come one after the other with the World's.
class SharedObserver {
 public:
  SharedObserver(std::shared_ptr<SharedWorld> world, Observer observer)
      : world_(std::move(world)), observer_(std::move(observer)) {}
  ~SharedObserver() { close(); }
  SharedObserver(const SharedObserver&) = delete;
  SharedObserver& operator=(const SharedObserver&) = delete;

  std::shared_ptr<Observation> next(double time_out_s) {
    return world_->with([&](World&) { return std::make_shared<Observation>(observer_.next(Seconds(time_out_s))); });
  }
  void close() {
    world_->with([&](World&) {
      const Observer ended = std::move(observer_);
      return 0;
    });
  }

 private:
  std::shared_ptr<SharedWorld> world_;
  Observer observer_;
};

void add_observing(py::module_& m, PyWorld& world) {
  py::class_<SharedObserver, std::shared_ptr<SharedObserver>>(m, "Observer")
      .def("next", &SharedObserver::next)
      .def("close", &SharedObserver::close);
  world.def("observe",
            [](const std::shared_ptr<SharedWorld>& w, std::uint32_t every, bool all, const Ids& bodies,
               const std::vector<std::string>& patterns, const std::vector<std::pair<Vec3, Vec3>>& boxes, bool contacts,
               bool joints, const std::vector<RayFan>& fans, const std::vector<Trigger>& triggers, double t) {
              Interest interest{every, all, ids_of(bodies), patterns, {}, contacts, joints, fans, triggers};
              for (const auto& [low, high] : boxes) interest.boxes.push_back({low, high});
              Observer observer = w->with([&](World& o) { return o.observe(interest, Seconds(t)); });
              return std::make_shared<SharedObserver>(w, std::move(observer));
            });
}

void add_steering(PyWorld& world) {
  world.def("pause",
            [](SharedWorld& w, double t) { return w.with([=](World& o) { return shared(o.pause(Seconds(t))); }); });
  world.def("step", [](SharedWorld& w, std::int64_t count, double t) {
    return w.with([=](World& o) { return shared(o.step(count, Seconds(t))); });
  });
  world.def("resume", [](SharedWorld& w, double t) { w.with([=](World& o) { o.resume(Seconds(t)); }); });
  world.def("reset", [](SharedWorld& w, double t) { w.with([=](World& o) { o.reset(Seconds(t)); }); });
  world.def("stop", [](SharedWorld& w, double t) { w.with([=](World& o) { o.stop(Seconds(t)); }); });
  world.def("set_rate", [](SharedWorld& w, double rate, double t) {
    return w.with([=](World& o) { return o.set_rate(rate, Seconds(t)); });
  });
  world.def("set_scene", [](SharedWorld& w, const std::string& name, double t) {
    return w.with([&](World& o) { return o.set_scene(name, Seconds(t)); });
  });
  world.def("set_regions", [](SharedWorld& w, const std::vector<std::array<double, 4>>& boxes, double t) {
    return w.with([&](World& o) { return o.set_regions(boxes, Seconds(t)); });
  });
  world.def("drain", [](SharedWorld& w, std::uint32_t region, double t) {
    return w.with([=](World& o) { return o.drain(region, Seconds(t)); });
  });
  world.def("save", [](SharedWorld& w, const std::string& name, double t) {
    return w.with([&](World& o) { return o.save(name, Seconds(t)); });
  });
  world.def("load", [](SharedWorld& w, const std::string& name, double t) {
    return w.with([&](World& o) { return o.load(name, Seconds(t)); });
  });
  world.def("back", [](SharedWorld& w, double t) { return w.with([=](World& o) { return o.back(Seconds(t)); }); });
}

void add_acting(PyWorld& world) {
  using Step = std::int64_t;
  world.def("spawn", [](SharedWorld& w, const std::string& prototype, const Shape& shape, double mass, const Vec3& p,
                        const Quaternion& q, const Vec3& v, const Vec3& spin, Step at, double t) {
    return w.with([&](World& o) { return o.spawn({prototype, shape, mass, p, q, v, spin}, at, Seconds(t)); });
  });
  world.def("add_static",
            [](SharedWorld& w, const Shape& shape, const Vec3& p, const Quaternion& q, Step at, double t) {
              return w.with([&](World& o) { return o.add_static({shape, p, q}, at, Seconds(t)); });
            });
  world.def("remove_body", [](SharedWorld& w, std::uint64_t body, Step at, double t) {
    return w.with([=](World& o) { return o.remove_body(body, at, Seconds(t)); });
  });
  world.def("remove_static", [](SharedWorld& w, std::uint32_t fixed, Step at, double t) {
    return w.with([=](World& o) { return o.remove_static(fixed, at, Seconds(t)); });
  });
  world.def("move_static", [](SharedWorld& w, const std::variant<std::uint32_t, std::string>& fixed, const Vec3& p,
                              const Quaternion& q, double duration, Step at, double t) {
    return w.with([&](World& o) { return o.move_static(fixed, p, q, duration, at, Seconds(t)); });
  });
  world.def("impulse",
            [](SharedWorld& w, std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point, Step at,
               double t) { return w.with([&](World& o) { return o.impulse(body, impulse, point, at, Seconds(t)); }); });
  world.def("set_velocity", [](SharedWorld& w, std::uint64_t body, const Vec3& linear,
                               const std::optional<Vec3>& angular, Step at, double t) {
    return w.with([&](World& o) { return o.set_velocity(body, linear, angular, at, Seconds(t)); });
  });
  using MaybeVectors = std::optional<std::pair<Ids, std::optional<Rows>>>;
  using Joints = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;
  using MaybeDrives = std::optional<std::pair<Joints, std::optional<Rows>>>;
  using Goal = std::tuple<std::variant<std::uint32_t, std::string>, Vec3, Quaternion, Step>;
  world.def("control", [](SharedWorld& w, const MaybeVectors& forces, const MaybeVectors& torques,
                          const MaybeVectors& velocities, const MaybeVectors& spins, const MaybeDrives& drives,
                          const std::vector<Goal>& goals, Step at, double t) {
    const auto vectors = [](const MaybeVectors& given) {
      if (!given) return BodyVectors{};
      return BodyVectors{ids_of(given->first),
                         given->second ? rows_of(given->first, *given->second) : std::vector<double>{}};
    };
    Control control{vectors(forces), vectors(torques), vectors(velocities), vectors(spins), {}, {}};
    if (drives) {
      const auto& [joints, rows] = *drives;
      control.drives.joints.assign(joints.data(), joints.data() + joints.size());
      for (py::ssize_t i = 0; rows && i < rows->shape(0); ++i) {
        const double* const d = rows->data(i, 0);
        control.drives.drives.push_back({d[0], d[1], d[2], d[3], d[4], d[5]});
      }
    }
    for (const auto& [fixed, p, q, states] : goals) control.statics.push_back({fixed, p, q, states});
    return w.with([&](World& o) { return o.control(control, at, Seconds(t)); });
  });
  world.def("impulses", [](SharedWorld& w, const Ids& ids, const Rows& rows, Step at, double t) {
    const std::vector<double> values = rows_of(ids, rows);
    const std::vector<std::uint64_t> bodies = ids_of(ids);
    return w.with([&](World& o) { return o.impulses(bodies, values, at, Seconds(t)); });
  });
  world.def("set_velocities", [](SharedWorld& w, const Ids& ids, const Rows& rows, Step at, double t) {
    const std::vector<double> values = rows_of(ids, rows);
    const std::vector<std::uint64_t> bodies = ids_of(ids);
    return w.with([&](World& o) { return o.set_velocities(bodies, values, at, Seconds(t)); });
  });
}

}  // namespace

PYBIND11_MODULE(_aurasim, m) {
  add_values(m);
  PyWorld world(m, "World");
  add_opening(world);
  add_sensing(world);
  add_steering(world);
  add_acting(world);
  add_observing(m, world);
  m.attr("__version__") = version();
}

}  // namespace aurasim::client
