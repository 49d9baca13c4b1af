// Drive a world from your program: join a run or launch one, see its bodies, act, step it in lock-step.
//
//   aurasim::client::World world = aurasim::client::World::launch("demo", {.paused = true});
//   const auto ball = world.spawn({.shape = aurasim::client::Shape::sphere(0.5), .position = {0, 0, 10}});
//   for (int i = 0; i < 100; ++i) {
//     const aurasim::client::Bodies bodies = world.step();
//     ...
//   }
//
// The DDS connection is in a process of its own, `aurasim agent`. Each World starts one, and it ends with the World,
// however this program ends. docs/client.md.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <aurasim/bodies.h>
#include <aurasim/errors.h>
#include <aurasim/observe.h>

namespace aurasim::client {

using Vec3 = std::array<double, 3>;
using Quaternion = std::array<double, 4>;  ///< w x y z; need not be of length 1
using Seconds = std::chrono::duration<double>;

inline constexpr Seconds kUsualTimeOut{60};

struct ConnectOptions {
  std::vector<std::string> overrides = {};  ///< "key.path=value", as --set: the same as the run's nodes have
  std::string as = {};                      ///< name of dds.security to join a run with keys; empty: the first operator
  Seconds time_out{15};                     ///< time for the nodes to be found
  std::string program = {};                 ///< `aurasim`; empty: $AURASIM_PROGRAM, beside this library, in $PATH
  std::string log = {};                     ///< file for the output of started processes; empty: none
  /// Called now and then while a call waits. If it returns true the call ends with Interrupted.
  std::function<bool()> interrupted = {};
};

struct LaunchOptions {
  std::vector<std::string> overrides = {};
  std::string as = {};
  Seconds time_out{60};  ///< time for all nodes to start
  std::string program = {};
  std::string log = {};
  std::function<bool()> interrupted = {};
  bool paused = false;      ///< pauses in state 0; with `load`, in the saved state
  std::string load = {};    ///< a saved world to go on from
  std::string report = {};  ///< folder for what the nodes record
  std::string saves = {};   ///< folder for the nodes' parts of saved worlds; empty: `saves`
  int spares = 0;           ///< spare processes that wait to take over the region of a node that dies
};

/// Shape of a new body or static.
struct AURASIM_API Shape {
  enum class Kind : std::uint8_t { kNone, kSphere, kBox, kCapsule, kMesh };
  Kind kind = Kind::kNone;
  Vec3 size = {};         ///< box: side lengths, m
  double radius_m = 0;    ///< sphere, capsule
  double height_m = 0;    ///< capsule along z, between the centres of its caps
  std::string file = {};  ///< mesh: OBJ, STL or glTF
  bool in_parts = false;  ///< mesh of a body: its convex parts; otherwise its hull

  static Shape sphere(double radius_m);
  static Shape box(const Vec3& size);
  static Shape capsule(double radius_m, double height_m);
  static Shape mesh(std::string file, bool in_parts = false);
};

struct NewBody {
  std::string prototype = {};  ///< a prototype of the scene; empty: `shape` and `mass_kg` count
  Shape shape = {};
  double mass_kg = 1;  ///< mass of a body with `shape`
  Vec3 position = {};  ///< m
  Quaternion rotation = {1, 0, 0, 0};
  Vec3 linear_velocity = {};   ///< m/s
  Vec3 angular_velocity = {};  ///< rad/s
};

struct NewStatic {
  Shape shape = {};
  Vec3 position = {};
  Quaternion rotation = {1, 0, 0, 0};
};

/// Result of an act.
struct Acknowledgement {
  std::int64_t step = 0;               ///< the first state that shows its effect
  std::optional<std::uint64_t> body;   ///< id of the body that was made
  std::optional<std::uint32_t> fixed;  ///< number of the static that was made
  std::string text;                    ///< description for people
};

/// Setpoints for some bodies: n ids, and n x 3 numbers in the world frame. Ids without numbers end the setpoints of
/// these bodies.
struct BodyVectors {
  std::vector<std::uint64_t> bodies;
  std::vector<double> values;
};

/// Drive of a joint: effort = stiffness (position - q) + damping (speed - dq/dt) + effort, limited to max_effort either
/// way. q is how far a hinge has turned (rad), or a slider moved (m), since state 0.
struct JointDrive {
  double position = 0;                                          ///< rad or m
  double speed = 0;                                             ///< rad/s or m/s
  double stiffness = 0;                                         ///< N m/rad or N/m
  double damping = 0;                                           ///< N m s/rad or N s/m
  double effort = 0;                                            ///< N m or N
  double max_effort = std::numeric_limits<double>::infinity();  ///< N m or N
};

/// Drives for some joints, which are named by their places in RunInfo::joints; one drive each. Without drives these
/// joints get the scene's drives back.
struct JointDrives {
  std::vector<std::uint32_t> joints;
  std::vector<JointDrive> drives;
};

/// Goal of a static: it moves evenly from where it is and then stays. It pushes what is in its way.
struct StaticGoal {
  std::variant<std::uint32_t, std::string> fixed = std::uint32_t{0};  ///< its number, or its name in the scene
  Vec3 position = {};                                                 ///< m
  Quaternion rotation = {1, 0, 0, 0};
  std::int64_t states = 1;  ///< until it is there; 1: in the first state that shows it
};

/// Setpoints for bodies, joints and statics. They hold until they are replaced or this World is gone (`control` of the
/// launch file).
struct Control {
  BodyVectors forces = {};      ///< N, at the centre of mass
  BodyVectors torques = {};     ///< N m
  BodyVectors velocities = {};  ///< m/s, held
  BodyVectors spins = {};       ///< rad/s, held
  JointDrives drives = {};
  std::vector<StaticGoal> statics = {};  ///< at most 64; solver soft_step only
};

struct RayHit {
  bool hit = false;
  bool complete = true;  ///< all regions have answered, so nothing nearer exists
  std::int64_t step = 0;
  std::optional<std::uint64_t> body;
  std::optional<std::uint32_t> fixed;
  Vec3 position = {};
  Vec3 normal = {};
  double distance_m = 0;
};

struct SavedWorld {
  std::int64_t step = 0;
  std::string file;  ///< file with the whole world; empty: the parts are on other hosts, or in several folders
  std::vector<std::string> parts;  ///< files with the parts if `file` is empty
};

/// An observation begun by World::observe(). It ends with this object or with the World. Used by the same thread as the
/// World.
class AURASIM_API Observer {
 public:
  Observer(Observer&&) noexcept;
  Observer& operator=(Observer&&) noexcept;
  ~Observer();

  /// Returns the next state, in order; waits for it. Up to 256 states are kept until they are asked for; then the
  /// oldest are dropped.
  Observation next(Seconds time_out = kUsualTimeOut);
  void close();

 private:
  friend class World;
  struct Impl;
  explicit Observer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A connection to a run. Used by one thread at a time. Every call throws one of the types in errors.h, at the latest
/// soon after its time-out. `at_step`: the act does not take effect before that state; 0: as soon as possible.
///
/// An act in a running world returns when its effect has been seen. In a paused world, or with `at_step`, it returns
/// when it is certain to take effect in the state that it returns.
class AURASIM_API World {
 public:
  /// Joins a run that was started elsewhere. `file`: its launch file, or the name of a shipped one.
  static World connect(const std::string& file, const ConnectOptions& options = {});
  /// Starts a run on this host. It ends when this World is closed or this program ends.
  static World launch(const std::string& file, const LaunchOptions& options = {});

  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// Ends the connection. A run that was launched ends in one state on all nodes and writes its report. Returns, once
  /// all has ended, the launcher's exit code, or that of an agent that died before (128 + its signal). Returns 0 if no
  /// run was launched, or if it was closed before.
  int close(Seconds time_out = Seconds{30});
  bool closed() const;
  /// Process id of the agent; 0: closed.
  int agent_pid() const;

  // Sense.
  RunInfo info(Seconds time_out = kUsualTimeOut);
  std::vector<NodeStatus> nodes(Seconds time_out = kUsualTimeOut);
  /// Returns all bodies. In a paused run: of the state in which it is paused, or will be within a second (a step of
  /// another client is waited for). Otherwise of the newest state that all regions have published.
  Bodies bodies(Seconds time_out = kUsualTimeOut);
  /// Returns the first hit on the way from one point to another, m. All regions are asked.
  RayHit ray(const Vec3& from, const Vec3& to, Seconds time_out = kUsualTimeOut);

  /// Begins to observe. Only what `interest` names is sent, up to every state. At most 16 observers at a time. Throws
  /// Refused for an invalid interest.
  Observer observe(const Interest& interest, Seconds time_out = kUsualTimeOut);

  // Steer. All nodes apply these in the same state.
  /// Pauses the run. Returns the bodies of the state in which all nodes are paused.
  Bodies pause(Seconds time_out = kUsualTimeOut);
  /// Computes `count` more states of a paused run. Returns the bodies of the last one, once all regions have published
  /// it. Steps of several clients add up, so it may be a later state. Throws Refused at once if the run is not paused.
  Bodies step(std::int64_t count = 1, Seconds time_out = kUsualTimeOut);
  void resume(Seconds time_out = kUsualTimeOut);
  /// Restarts the scene, or the saved world that the run began with. A paused run stays paused, in the first state.
  void reset(Seconds time_out = kUsualTimeOut);
  void stop(Seconds time_out = kUsualTimeOut);
  /// Sets the rate: simulated seconds per second, 0.01 to 10.
  Acknowledgement set_rate(double rate, Seconds time_out = kUsualTimeOut);
  /// Restarts with another scene beside the launch file's, or with the same one, which is read again. A paused run
  /// stays paused, in state 0.
  Acknowledgement set_scene(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// Sets the region map: one box for each region, x0 y0 x1 y1, m; infinite sides allowed.
  Acknowledgement set_regions(const std::vector<std::array<double, 4>>& boxes, Seconds time_out = kUsualTimeOut);
  /// Makes the region's node leave, and another process take over the region. Returns that process's number.
  std::uint32_t drain(std::uint32_t region, Seconds time_out = kUsualTimeOut);

  // Keep.
  // A saved world has a name of letters, digits, '.', '_' and '-'. It is a file in the nodes' folder of saved worlds
  // (LaunchOptions::saves). A path instead of a name throws Refused.
  /// Saves the world: a paused run in the state in which it is paused, any other in the next state that all nodes can
  /// save.
  SavedWorld save(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// Continues from a saved world. A paused run stays paused, in the saved state.
  Acknowledgement load(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// Goes back to the newest earlier state that is kept.
  Acknowledgement back(Seconds time_out = kUsualTimeOut);

  // Act.
  Acknowledgement spawn(const NewBody& body, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement add_static(const NewStatic& fixed, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement remove_body(std::uint64_t body, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement remove_static(std::uint32_t fixed, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Moves a static evenly from where it is; then it stays. `fixed`: its number, or its name in the scene. It pushes
  /// what is in its way. Units: m, quaternion w x y z, s of simulated time.
  Acknowledgement move_static(const std::variant<std::uint32_t, std::string>& fixed, const Vec3& position,
                              const Quaternion& rotation, double duration, std::int64_t at_step = 0,
                              Seconds time_out = kUsualTimeOut);
  /// Applies an impulse, N s, at a point (m) or at the centre of mass. World frame.
  Acknowledgement impulse(std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point = {},
                          std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Sets velocities, m/s and rad/s. Without `angular` the spin stays as it is.
  Acknowledgement set_velocity(std::uint64_t body, const Vec3& linear, const std::optional<Vec3>& angular = {},
                               std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Sends setpoints to bodies and joints, wherever they are hosted. Returns at once, with the first state that shows
  /// them: in a paused run the next state, otherwise (`at_step` 0) lookahead + 1 states after each node has received
  /// them. A setpoint that arrives after its state has been computed is late (NodeStatus::setpoints_late). Statics of a
  /// running world without `at_step` take the time of an order. Throws Refused, without any effect, for an unknown
  /// body, joint or static, and for a number that is not finite or beyond 1e9.
  std::int64_t control(const Control& control, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Applies an impulse to each of `bodies` in one request: at most 300 between two states. `impulses`: n x 3, N s.
  /// Throws Refused with the first reason if any is refused; the others take effect.
  std::vector<Acknowledgement> impulses(const std::vector<std::uint64_t>& bodies, const std::vector<double>& impulses,
                                        std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Sets the velocity of each of `bodies` in one request, with the limits and errors of impulses(). `linear`: n x 3,
  /// m/s.
  std::vector<Acknowledgement> set_velocities(const std::vector<std::uint64_t>& bodies,
                                              const std::vector<double>& linear, std::int64_t at_step = 0,
                                              Seconds time_out = kUsualTimeOut);

 private:
  friend class Observer;
  struct Impl;
  explicit World(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;  ///< shared, so that observers can check whether it still exists
};

/// Version of this library, e.g. "0.1.0".
AURASIM_API const char* version();

}  // namespace aurasim::client
