// Drive a world from your program: join a run or launch one, see its bodies, act, step it in lock-step.
//
//   aurasim::client::World world = aurasim::client::World::launch("demo", {.paused = true});
//   const auto ball = world.spawn({.shape = aurasim::client::Shape::sphere(0.5), .position = {0, 0, 10}});
//   for (int i = 0; i < 100; ++i) {
//     const aurasim::client::Bodies bodies = world.step();
//     ...
//   }
//
// DDS is spoken by a process of its own, `aurasim agent`, that each World starts and that ends with it, however this
// program ends. docs/client.md.
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
  std::string as = {};                      ///< in a run with keys, a name of dds.security; empty: the first operator
  Seconds time_out{15};                     ///< for the nodes to be found
  std::string program = {};                 ///< `aurasim`; empty: $AURASIM_PROGRAM, beside this library, in $PATH
  std::string log = {};                     ///< file for the words of the processes that are started; empty: none
  /// Asked now and then while a call waits; if true the call ends with Interrupted.
  std::function<bool()> interrupted = {};
};

struct LaunchOptions {
  std::vector<std::string> overrides = {};
  std::string as = {};
  Seconds time_out{60};  ///< for all nodes to have begun
  std::string program = {};
  std::string log = {};
  std::function<bool()> interrupted = {};
  bool paused = false;      ///< stands in state 0; with `load`, in the state that was saved
  std::string load = {};    ///< a saved world to go on from
  std::string report = {};  ///< folder for what the nodes record
  std::string saves = {};   ///< folder for the nodes' parts of saved worlds; empty: `saves`
  int spares = 0;           ///< processes that wait to take over the region of a node that dies
};

/// Of a new body or static.
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
  std::string prototype = {};  ///< one of the scene's kinds of bodies; or else
  Shape shape = {};
  double mass_kg = 1;  ///< of a shape
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

/// What became of an act.
struct Acknowledgement {
  std::int64_t step = 0;               ///< the first state that shows its effect
  std::optional<std::uint64_t> body;   ///< that was made
  std::optional<std::uint32_t> fixed;  ///< static that was made
  std::string text;                    ///< for people
};

/// For some bodies: n ids, and n x 3 numbers, world frame. Without numbers they are let go of.
struct BodyVectors {
  std::vector<std::uint64_t> bodies;
  std::vector<double> values;
};

/// effort = stiffness (position - q) + damping (speed - dq/dt) + effort, at most max_effort either way, where q is how
/// far a hinge has turned (rad), or a slider moved (m), from where it was in state 0.
struct JointDrive {
  double position = 0;                                          ///< rad or m
  double speed = 0;                                             ///< rad/s or m/s
  double stiffness = 0;                                         ///< N m/rad or N/m
  double damping = 0;                                           ///< N m s/rad or N s/m
  double effort = 0;                                            ///< N m or N
  double max_effort = std::numeric_limits<double>::infinity();  ///< N m or N
};

/// For some joints, by their places in RunInfo::joints: a drive for each. Without drives they have the scene's again.
struct JointDrives {
  std::vector<std::uint32_t> joints;
  std::vector<JointDrive> drives;
};

/// Where a static goes: evenly from where it is, and then it stays. It pushes what is in its way.
struct StaticGoal {
  std::variant<std::uint32_t, std::string> fixed = std::uint32_t{0};  ///< its number, or its name in the scene
  Vec3 position = {};                                                 ///< m
  Quaternion rotation = {1, 0, 0, 0};
  std::int64_t states = 1;  ///< until it is there; 1: in the first state that shows it
};

/// What is wanted of bodies, joints and statics: holds until something else is said, or this World is gone (`control`
/// of the launch file).
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
  bool complete = true;  ///< all regions have answered: there is nothing nearer
  std::int64_t step = 0;
  std::optional<std::uint64_t> body;
  std::optional<std::uint32_t> fixed;
  Vec3 position = {};
  Vec3 normal = {};
  double distance_m = 0;
};

struct SavedWorld {
  std::int64_t step = 0;
  std::string file;                ///< the whole world; empty: the parts are on other hosts, or in several folders
  std::vector<std::string> parts;  ///< else
};

/// What World::observe() has begun; it ends with this, or with the World. Used as the World is.
class AURASIM_API Observer {
 public:
  Observer(Observer&&) noexcept;
  Observer& operator=(Observer&&) noexcept;
  ~Observer();

  /// The next state, in order; waits for it. One that has come is kept until it is asked for: up to 256 of them, then
  /// the oldest go.
  Observation next(Seconds time_out = kUsualTimeOut);
  void close();

 private:
  friend class World;
  struct Impl;
  explicit Observer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Used by one thread at a time. Every call throws one of errors.h, at the latest soon after its time-out. Where it
/// says `at_step`: not before that state; 0: as soon as possible.
///
/// An act in a running world returns when its effect has been seen; in a paused one, or with `at_step`, when it is
/// certain to come: in the state that it says.
class AURASIM_API World {
 public:
  /// Joins a run that was started elsewhere. `file`: its launch file, or the name of a shipped one.
  static World connect(const std::string& file, const ConnectOptions& options = {});
  /// Starts one on this host: it ends when this World is closed, or this program ends.
  static World launch(const std::string& file, const LaunchOptions& options = {});

  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// Ends what it has started: a run that was launched ends in one state on all nodes and writes its report. Returns,
  /// once all has ended, the launcher's exit code, or that of an agent that died before (128 + its signal); 0 where
  /// none was launched, and when closed before.
  int close(Seconds time_out = Seconds{30});
  bool closed() const;
  /// Of the agent; 0: closed.
  int agent_pid() const;

  // Sense.
  RunInfo info(Seconds time_out = kUsualTimeOut);
  std::vector<NodeStatus> nodes(Seconds time_out = kUsualTimeOut);
  /// In a paused run the state in which it stands, or will within a second: a step of another client is waited for.
  /// Else the newest that all regions have published.
  Bodies bodies(Seconds time_out = kUsualTimeOut);
  /// What is first on the way from a point to another, m? All regions are asked.
  RayHit ray(const Vec3& from, const Vec3& to, Seconds time_out = kUsualTimeOut);

  /// Begins to observe: only what is asked for is sent, up to every state. At most 16 observers at a time. Throws
  /// Refused for what cannot be asked for.
  Observer observe(const Interest& interest, Seconds time_out = kUsualTimeOut);

  // Steer. All nodes do so in one state.
  /// Returns the bodies of the state in which all stand.
  Bodies pause(Seconds time_out = kUsualTimeOut);
  /// Computes `count` states more of a paused run; returns the bodies of the last one, once all regions have told it.
  /// Steps of several clients add up: then it may be a later state. Throws Refused at once if the run is not paused.
  Bodies step(std::int64_t count = 1, Seconds time_out = kUsualTimeOut);
  void resume(Seconds time_out = kUsualTimeOut);
  /// The scene, or the saved world that the run has begun with, begins anew. A paused run stands in its first state.
  void reset(Seconds time_out = kUsualTimeOut);
  void stop(Seconds time_out = kUsualTimeOut);
  /// Simulated seconds per second, 0.01 to 10.
  Acknowledgement set_rate(double rate, Seconds time_out = kUsualTimeOut);
  /// Begins anew with another scene beside the launch file's, or with the same one as its file is now. In a paused run
  /// all stand in its state 0.
  Acknowledgement set_scene(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// One box for each region, x0 y0 x1 y1, m; infinite sides allowed.
  Acknowledgement set_regions(const std::vector<std::array<double, 4>>& boxes, Seconds time_out = kUsualTimeOut);
  /// The region's node leaves, and another process takes it over. Returns that one's number.
  std::uint32_t drain(std::uint32_t region, Seconds time_out = kUsualTimeOut);

  // Keep.
  // A saved world has a name, of letters, digits, '.', '_' and '-', and is a file in the nodes' folder of saved worlds
  // (LaunchOptions::saves). A path is Refused.
  /// A paused run is saved in the state in which it stands, any other in the next one that all nodes can save.
  SavedWorld save(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// Goes on from a saved world; a paused run stands in its state.
  Acknowledgement load(const std::string& name, Seconds time_out = kUsualTimeOut);
  /// Goes back to the newest earlier state that is kept.
  Acknowledgement back(Seconds time_out = kUsualTimeOut);

  // Act.
  Acknowledgement spawn(const NewBody& body, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement add_static(const NewStatic& fixed, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement remove_body(std::uint64_t body, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  Acknowledgement remove_static(std::uint32_t fixed, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// It goes evenly from where it is and stays there; `fixed`: its number, or the name that the scene gives it. It
  /// pushes what is in its way. m, quaternion w x y z, s of simulated time.
  Acknowledgement move_static(const std::variant<std::uint32_t, std::string>& fixed, const Vec3& position,
                              const Quaternion& rotation, double duration, std::int64_t at_step = 0,
                              Seconds time_out = kUsualTimeOut);
  /// N s, at a point (m) or the centre of mass. World frame.
  Acknowledgement impulse(std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point = {},
                          std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// m/s and rad/s; without a spin it stays as it is.
  Acknowledgement set_velocity(std::uint64_t body, const Vec3& linear, const std::optional<Vec3>& angular = {},
                               std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Steers bodies and joints, wherever they are hosted by then. Returns at once, with the first state that shows it.
  /// In a paused run that is by itself the next state, else (0) lookahead + 1 states after each node has heard of it;
  /// what comes after its state has been computed is late (NodeStatus::setpoints_late). Statics of a running world for
  /// which no state is named take the time of an order. Throws Refused, and nothing acts, for an unknown body, joint or
  /// static, or a number that is not finite or beyond 1e9.
  std::int64_t control(const Control& control, std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// One for each body, asked for together: at most 300 between two states. `impulses`: n x 3. Throws Refused with the
  /// first reason if any is refused; the others act.
  std::vector<Acknowledgement> impulses(const std::vector<std::uint64_t>& bodies, const std::vector<double>& impulses,
                                        std::int64_t at_step = 0, Seconds time_out = kUsualTimeOut);
  /// Likewise. `linear`: n x 3.
  std::vector<Acknowledgement> set_velocities(const std::vector<std::uint64_t>& bodies,
                                              const std::vector<double>& linear, std::int64_t at_step = 0,
                                              Seconds time_out = kUsualTimeOut);

 private:
  friend class Observer;
  struct Impl;
  explicit World(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;  ///< observers look whether it is still there
};

/// "0.1.0", of this library.
AURASIM_API const char* version();

}  // namespace aurasim::client
