#include "python/values.h"

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <aurasim/client.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace py = pybind11;

namespace aurasim::client {
namespace {

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

template <class Owner, class T>
void add_array(py::class_<Owner, std::shared_ptr<Owner>>& type, const char* name, const std::vector<T> Owner::*column,
               py::ssize_t width = 1) {
  type.def_property_readonly(
      name, [=](const py::object& self) { return view<Owner, T>(self, column, width, py::dtype::of<T>()); });
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

/// A part of an observation, which keeps it.
template <class Part>
void add_part(py::class_<Observation, std::shared_ptr<Observation>>& type, const char* name, Part Observation::*part) {
  type.def_property_readonly(
      name, [=](const std::shared_ptr<Observation>& self) { return std::shared_ptr<Part>(self, &((*self).*part)); });
}

template <class Part>
void add_parts(py::class_<Observation, std::shared_ptr<Observation>>& type, const char* name,
               std::vector<Part> Observation::*parts) {
  type.def_property_readonly(name, [=](const std::shared_ptr<Observation>& self) {
    py::list all;
    for (Part& part : (*self).*parts) all.append(std::shared_ptr<Part>(self, &part));
    return all;
  });
}

void add_sensed(py::module_& m) {
  py::class_<Contacts, std::shared_ptr<Contacts>> contacts(m, "Contacts");
  contacts.def("__len__", &Contacts::size);
  add_array(contacts, "a", &Contacts::a);
  add_array(contacts, "b", &Contacts::b);
  add_array(contacts, "positions", &Contacts::positions, 3);
  add_array(contacts, "normals", &Contacts::normals, 3);
  add_array(contacts, "impulses", &Contacts::impulses);
  py::class_<Joints, std::shared_ptr<Joints>> joints(m, "Joints");
  joints.def("__len__", &Joints::size);
  add_array(joints, "ids", &Joints::ids);
  add_array(joints, "positions", &Joints::positions);
  add_array(joints, "speeds", &Joints::speeds);
  py::class_<FanHits, std::shared_ptr<FanHits>> fan(m, "FanHits");
  fan.def("__len__", &FanHits::size).def_readonly("cast", &FanHits::cast).def_readonly("complete", &FanHits::complete);
  add_array(fan, "objects", &FanHits::objects);
  add_array(fan, "distances", &FanHits::distances);
  add_array(fan, "positions", &FanHits::positions, 3);
  add_array(fan, "normals", &FanHits::normals, 3);
  py::class_<TriggerEvents, std::shared_ptr<TriggerEvents>> trigger(m, "TriggerEvents");
  trigger.def_readonly("complete", &TriggerEvents::complete);
  add_array(trigger, "inside", &TriggerEvents::inside);
  add_array(trigger, "entered", &TriggerEvents::entered);
  add_array(trigger, "left", &TriggerEvents::left);
}

void add_observation(py::module_& m) {
  add_sensed(m);
  py::class_<Observation, std::shared_ptr<Observation>> type(m, "Observation");
  type.def_property_readonly("step", [](const Observation& o) { return o.bodies.step; })
      .def_property_readonly("time", [](const Observation& o) { return o.bodies.time_s; })
      .def_property_readonly("generation", [](const Observation& o) { return o.bodies.generation; })
      .def_property_readonly("complete", [](const Observation& o) { return o.bodies.exact; })
      .def_readonly("redo", &Observation::redo)
      .def_readonly("skipped", &Observation::skipped)
      .def_readonly("silent", &Observation::silent)
      .def("__repr__", [](const Observation& o) {
        return "<aurasim.Observation: " + std::to_string(o.bodies.size()) + " bodies in state " +
               std::to_string(o.bodies.step) + ">";
      });
  add_array(type, "missing", &Observation::missing);
  add_part(type, "bodies", &Observation::bodies);
  add_part(type, "contacts", &Observation::contacts);
  add_part(type, "joints", &Observation::joints);
  add_parts(type, "fans", &Observation::fans);
  add_parts(type, "triggers", &Observation::triggers);
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

void add_interest(py::module_& m) {
  py::class_<RayFan>(m, "RayFan")
      .def(py::init([](const Rows& directions, double range, const std::optional<std::uint64_t>& body,
                       const Vec3& position, const Quaternion& rotation, std::int64_t every) {
             if (directions.ndim() != 2 || directions.shape(1) != 3)
               throw py::value_error("directions: allowed: n x 3");
             return RayFan{mount_of(body, position, rotation),
                           {directions.data(), directions.data() + directions.size()},
                           range,
                           every};
           }),
           py::arg("directions"), py::arg("range"), py::kw_only(), py::arg("body") = py::none(),
           py::arg("position") = Vec3{}, py::arg("rotation") = Quaternion{1, 0, 0, 0}, py::arg("every") = 1)
      .def_static(
          "grid",
          [](double from, double to, int columns, double up_from, double up_to, int rows) {
            const std::vector<double> all = RayFan::grid(from, to, columns, up_from, up_to, rows);
            return py::array_t<double>({static_cast<py::ssize_t>(all.size() / 3), py::ssize_t{3}}, all.data());
          },
          py::arg("azimuth_from"), py::arg("azimuth_to"), py::arg("columns"), py::arg("elevation_from") = 0.0,
          py::arg("elevation_to") = 0.0, py::arg("rows") = 1)
      .def_property_readonly_static("NOTHING", [](const py::object&) { return FanHits::kNothing; });
  py::class_<Trigger>(m, "Trigger")
      .def_static(
          "box",
          [](const Vec3& size, const std::optional<std::uint64_t>& body, const Vec3& p, const Quaternion& q) {
            return Trigger{mount_of(body, p, q), size, 0};
          },
          py::arg("size"), py::kw_only(), py::arg("body") = py::none(), py::arg("position") = Vec3{},
          py::arg("rotation") = Quaternion{1, 0, 0, 0})
      .def_static(
          "ball",
          [](double radius, const std::optional<std::uint64_t>& body, const Vec3& p) {
            return Trigger{mount_of(body, p, {1, 0, 0, 0}), {}, radius};
          },
          py::arg("radius"), py::kw_only(), py::arg("body") = py::none(), py::arg("position") = Vec3{});
}

}  // namespace

void add_values(py::module_& m) {
  add_errors(m);
  add_bodies(m);
  add_observation(m);
  add_reports(m);
  add_interest(m);
}

}  // namespace aurasim::client
