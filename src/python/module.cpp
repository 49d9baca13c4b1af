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

/// A column, seen and not copied: it keeps its owner. Read only.
template <class Owner, class T>
py::array view(const py::object& owner, const std::vector<T> Owner::*column, py::ssize_t width, const py::dtype& type) {
  const auto& values = owner.cast<const Owner&>().*column;
  const auto rows = static_cast<py::ssize_t>(values.size()) / width;
  std::vector<py::ssize_t> shape = {rows};
  if (width > 1) shape.push_back(width);
  py::array array(type, std::move(shape), values.data(), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

template <class T>
void add_column(py::class_<Bodies, std::shared_ptr<Bodies>>& type, const char* name,
                const std::vector<T> Bodies::*column, py::ssize_t width = 1) {
  type.def_property_readonly(
      name, [=](const py::object& self) { return view<Bodies, T>(self, column, width, py::dtype::of<T>()); });
}

void add_flags(py::class_<Bodies, std::shared_ptr<Bodies>>& type, const char* name,
               const std::vector<std::uint8_t> Bodies::*column) {
  type.def_property_readonly(
      name, [=](const py::object& self) { return view<Bodies, std::uint8_t>(self, column, 1, py::dtype::of<bool>()); });
}

void add_bodies(py::module_& m) {
  py::class_<Bodies, std::shared_ptr<Bodies>> bodies(m, "Bodies");
  bodies.def_readonly("step", &Bodies::step)
      .def_readonly("time", &Bodies::time_s)
      .def_readonly("generation", &Bodies::generation)
      .def_readonly("exact", &Bodies::exact)
      .def("__len__", &Bodies::size)
      .def("__repr__", [](const Bodies& b) {
        return "<aurasim.Bodies: " + std::to_string(b.size()) + " in state " + std::to_string(b.step) + ">";
      });
  add_column(bodies, "ids", &Bodies::ids);
  add_column(bodies, "positions", &Bodies::positions, 3);
  add_column(bodies, "rotations", &Bodies::rotations, 4);
  add_column(bodies, "linear_velocities", &Bodies::linear_velocities, 3);
  add_column(bodies, "angular_velocities", &Bodies::angular_velocities, 3);
  add_column(bodies, "regions", &Bodies::regions);
  add_column(bodies, "epochs", &Bodies::epochs);
  add_column(bodies, "prototypes", &Bodies::prototypes);
  add_flags(bodies, "asleep", &Bodies::asleep);
  add_flags(bodies, "under_way", &Bodies::under_way);
}

void add_reports(py::module_& m) {
  py::class_<NodeStatus>(m, "NodeStatus")
      .def_readonly("region", &NodeStatus::region)
      .def_readonly("state", &NodeStatus::state)
      .def_readonly("pid", &NodeStatus::pid)
      .def_readonly("step", &NodeStatus::step)
      .def_readonly("generation", &NodeStatus::generation)
      .def_readonly("bodies", &NodeStatus::bodies)
      .def_readonly("awake", &NodeStatus::awake)
      .def_readonly("foreign_auras", &NodeStatus::foreign_auras)
      .def_readonly("hand_offs_out", &NodeStatus::hand_offs_out)
      .def_readonly("hand_offs_in", &NodeStatus::hand_offs_in)
      .def_readonly("violations", &NodeStatus::violations)
      .def_readonly("redos", &NodeStatus::redos)
      .def_readonly("setpoints_heard", &NodeStatus::setpoints_heard)
      .def_readonly("setpoints_late", &NodeStatus::setpoints_late)
      .def_readonly("setpoints_refused", &NodeStatus::setpoints_refused)
      .def_readonly("frame_ms_p50", &NodeStatus::frame_ms_p50)
      .def_readonly("frame_ms_p99", &NodeStatus::frame_ms_p99)
      .def_readonly("real_time_factor", &NodeStatus::real_time_factor)
      .def_readonly("rate", &NodeStatus::rate)
      .def_readonly("box", &NodeStatus::box)
      .def_readonly("dead", &NodeStatus::dead)
      .def_readonly("text", &NodeStatus::text)
      .def("__repr__", [](const NodeStatus& n) {
        return "<aurasim.NodeStatus: region " + std::to_string(n.region) + " " + n.state + " at " +
               std::to_string(n.step) + ">";
      });
  py::class_<RunInfo>(m, "RunInfo")
      .def_readonly("file", &RunInfo::file)
      .def_readonly("scene", &RunInfo::scene)
      .def_readonly("key", &RunInfo::key)
      .def_readonly("domain", &RunInfo::domain)
      .def_readonly("step_s", &RunInfo::step_s)
      .def_readonly("tick_hz", &RunInfo::tick_hz)
      .def_readonly("lookahead", &RunInfo::lookahead)
      .def_readonly("sync", &RunInfo::sync)
      .def_readonly("prototypes", &RunInfo::prototypes)
      .def_readonly("joints", &RunInfo::joints)
      .def_readonly("regions", &RunInfo::regions);
  py::class_<Acknowledgement>(m, "Acknowledgement")
      .def_readonly("step", &Acknowledgement::step)
      .def_readonly("body", &Acknowledgement::body)
      .def_readonly("fixed", &Acknowledgement::fixed)
      .def_readonly("text", &Acknowledgement::text)
      .def("__repr__", [](const Acknowledgement& a) {
        return "<aurasim.Acknowledgement: from state " + std::to_string(a.step) + " on: " + a.text + ">";
      });
  py::class_<RayHit>(m, "RayHit")
      .def_readonly("hit", &RayHit::hit)
      .def_readonly("complete", &RayHit::complete)
      .def_readonly("step", &RayHit::step)
      .def_readonly("body", &RayHit::body)
      .def_readonly("fixed", &RayHit::fixed)
      .def_readonly("position", &RayHit::position)
      .def_readonly("normal", &RayHit::normal)
      .def_readonly("distance", &RayHit::distance_m);
  py::class_<SavedWorld>(m, "SavedWorld")
      .def_readonly("step", &SavedWorld::step)
      .def_readonly("file", &SavedWorld::file)
      .def_readonly("parts", &SavedWorld::parts);
  py::class_<Shape>(m, "Shape")
      .def_static("sphere", &Shape::sphere, py::arg("radius"))
      .def_static("box", &Shape::box, py::arg("size"))
      .def_static("capsule", &Shape::capsule, py::arg("radius"), py::arg("height"))
      .def_static("mesh", &Shape::mesh, py::arg("file"), py::arg("in_parts") = false);
}

template <class Kind>
void add_error(py::module_& m, const char* name, const py::object& base) {
  py::register_exception<Kind>(m, name, base);
}

void add_errors(py::module_& m) {
  const py::object error = py::register_exception<Error>(m, "Error", PyExc_RuntimeError);
  add_error<BadFile>(m, "BadFile", py::make_tuple(error, py::handle(PyExc_ValueError)));
  add_error<NoSuchRun>(m, "NoSuchRun", error);
  add_error<RunDiffers>(m, "RunDiffers", error);
  add_error<LaunchFailed>(m, "LaunchFailed", error);
  add_error<TimedOut>(m, "TimedOut", py::make_tuple(error, py::handle(PyExc_TimeoutError)));
  add_error<Refused>(m, "Refused", error);
  add_error<Ended>(m, "Ended", error);
  add_error<NoProgram>(m, "NoProgram", error);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Interrupted& why) {  // Python knows its own reason
      if (PyErr_Occurred() == nullptr) PyErr_SetString(PyExc_KeyboardInterrupt, why.what());
    }
  });
}

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
  world.def("save", [](SharedWorld& w, const std::string& file, double t) {
    return w.with([&](World& o) { return o.save(file, Seconds(t)); });
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
  world.def("control",
            [](SharedWorld& w, const MaybeVectors& forces, const MaybeVectors& torques, const MaybeVectors& velocities,
               const MaybeVectors& spins, const MaybeDrives& drives, Step at, double t) {
              const auto vectors = [](const MaybeVectors& given) {
                if (!given) return BodyVectors{};
                return BodyVectors{ids_of(given->first),
                                   given->second ? rows_of(given->first, *given->second) : std::vector<double>{}};
              };
              Control control{vectors(forces), vectors(torques), vectors(velocities), vectors(spins), {}};
              if (drives) {
                const auto& [joints, rows] = *drives;
                control.drives.joints.assign(joints.data(), joints.data() + joints.size());
                for (py::ssize_t i = 0; rows && i < rows->shape(0); ++i) {
                  const double* const d = rows->data(i, 0);
                  control.drives.drives.push_back({d[0], d[1], d[2], d[3], d[4], d[5]});
                }
              }
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
  add_errors(m);
  add_bodies(m);
  add_reports(m);
  PyWorld world(m, "World");
  add_opening(world);
  add_sensing(world);
  add_steering(world);
  add_acting(world);
  m.attr("__version__") = version();
}

}  // namespace aurasim::client
