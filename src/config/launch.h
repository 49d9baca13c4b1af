// A launch file as one struct with defaults, and how to read it. Every error says file:line:column, the field,
// what was found and what is allowed. Unknown keys are errors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/discovery.h"
#include "core/aura.h"
#include "core/region_map.h"
#include "core/scene.h"
#include "core/setpoint.h"
#include "core/sync_mode.h"

namespace aurasim::config {

enum class Pace { kWall, kNone };
/// Whether states are put back and computed again. kAuto: if the run is to have the same bits as one node.
enum class Redo { kAuto, kOn, kOff };
/// The messages by which bodies of two regions can touch (docs/design.md, "Coupled regions"). kAuto: the nodes choose
/// when they meet.
enum class Exchange { kAura, kCoupled, kAuto };
enum class OnDeath { kRecover, kStop };

struct Time {
  double step_hz = 60;
  int substeps = 8;
  core::SyncMode sync = core::SyncMode::kBounded;
  std::optional<int> lookahead;  ///< K; nothing: derived from the tolerances
  Pace pace = Pace::kWall;
  Redo redo = Redo::kAuto;
};

struct Tolerances {
  double speed_m_s = 32;
  double latency_s = 0.002;
  double frame_s = 0.015;
};

struct Aura {
  core::AuraKind radius = core::AuraKind::kSwept;
  std::optional<double> uncertainty;  ///< U of docs/design.md, "Swept auras"; nothing: by time.sync
};

struct Physics {
  /// True when contacts are found once a step.
  bool looks_once() const { return solver == "soft_step"; }
  bool is_continuous() const { return continuous.value_or(looks_once()); }

  std::string solver = "soft_step";
  int iterations = 10;
  int friction_directions = 1;     ///< rows of friction at each contact point, 1 or 2
  double contact_erp = 0.2;        ///< share of an overlap undone in each substep, by a speed that remains
  std::optional<bool> continuous;  ///< fast bodies stop at obstacles; nothing: yes where contacts are found once a step
  std::optional<double> block_m;   ///< side of the blocks; nothing: by the bodies of the scene
  std::optional<int> threads;      ///< threads of a node's physics; nothing: as many as the host has for it
};

/// Impairment of the network. Values that are not given come from the DDS profiles.
struct Impair {
  std::optional<double> delay_s;        ///< delay, one way
  std::optional<double> jitter_s;       ///< delay +- jitter, uniform
  std::optional<double> loss;           ///< 0 to 1, of datagrams
  std::optional<double> bandwidth_B_s;  ///< limit for all that a node sends; 0: unlimited
  std::optional<bool> reorder;
  std::optional<bool> discovery;
  std::optional<std::uint64_t> seed;
};

struct Dds {
  int domain = 0;
  std::filesystem::path profiles;  ///< absolute, once read
  Discovery discovery = Discovery::kAuto;
  std::vector<std::string> interfaces = {"127.0.0.1"};
  /// For Discovery::kPeers and kServer, and the other hubs for Discovery::kNeighbours: "address" or "address:port".
  std::vector<std::string> peers;
  std::string hub;  ///< for Discovery::kNeighbours: address of the site's hub; empty: that of the first interface
  std::filesystem::path security;  ///< folder with this process's keys, absolute once read; empty: an open run
  Impair impair;
};

/// How a run reacts to the death of a node.
struct Survival {
  OnDeath on_death = OnDeath::kRecover;
  double checkpoint_s = 1;  ///< simulated time between cuts
  double patience_s = 20;   ///< time that the others wait for a spare to take the region over, before one of them does
  std::string disk;  ///< folder, relative to the launch file; "off"; empty: where --saves is given, in that folder
};

/// Control by programs that steer bodies and joints.
struct Control {
  core::LateSetpoint late = core::LateSetpoint::kNextState;
  core::OnSilence on_silence = core::OnSilence::kHold;
  double silence_s = 0.5;            ///< simulated time without a message after which a program counts as silent
  std::filesystem::path replay;      ///< setpoints.csv of an earlier run, absolute once read; empty: none
  std::uint64_t replay_content = 0;  ///< hash of the content of `replay`
};

struct Observe {
  double tick_hz = 20;
};

/// Topics that nodes publish to ROS 2 and receive from it (docs/ros2.md).
struct Ros2 {
  bool on = false;
  std::optional<int> domain;  ///< ROS_DOMAIN_ID; nothing: the run's
  double tf_hz = 20;
  std::string frame = "world";
  std::vector<std::string> cmd_vel;  ///< names of bodies that accept cmd_vel
};

/// PEM files, absolute once read.
struct Tls {
  std::filesystem::path certificate;  ///< the certificate, followed by those of its issuers if there are any
  std::filesystem::path key;
};

/// The viewer's server.
struct Overseer {
  std::string bind = "127.0.0.1";  ///< address that it listens on
  int port = 8080;                 ///< 0: any that is free
  std::optional<Tls> tls;          ///< nothing: plain HTTP
};

/// Place in the scene file where a thing is described, for messages about it.
struct SceneSource {
  std::string name;  ///< name in the file; may be empty
  int line = 0;      ///< line; 0: in an override instead of the file
  int column = 0;
};

struct Launch {
  std::filesystem::path file;          ///< absolute
  std::vector<std::string> overrides;  ///< overrides as given
  std::filesystem::path scene_file;
  core::Scene scene;
  std::vector<SceneSource> body_sources;      ///< as scene.bodies
  std::vector<SceneSource> injector_sources;  ///< as scene.injectors
  core::RegionMap regions = core::RegionMap::columns(1, 1);
  bool neighbour_distance_is_given = false;
  double neighbour_distance_m = 0;      ///< regions at most this far apart are neighbours; at least the zone
  Exchange exchange = Exchange::kAuto;  ///< kAuto only where both of the others are possible
  std::string why_exchange;  ///< reason why `auto` in the file can mean only `exchange`; empty: no such reason
  std::optional<double> exchange_limit_given_s;  ///< exchange_limit; nothing: derived from the steps
  Time time;
  Tolerances tolerances;
  Aura aura;
  Physics physics;
  Dds dds;
  Observe observe;
  Control control;
  Ros2 ros2;
  Overseer overseer;
  Survival survival;

  double step_s() const { return 1.0 / time.step_hz; }
  /// K of docs/design.md, "Time and lookahead".
  int lookahead() const;
  /// Side of the blocks, m.
  double block_m() const;
  /// U of docs/design.md, "Swept auras".
  double uncertainty() const;
  /// True when contacts between bodies of several regions are solved by all of these regions.
  bool is_coupled() const { return exchange == Exchange::kCoupled && regions.size() > 1; }
  /// Longest round trip, s, at which `exchange: auto` couples regions. Unless it is given, the exchanges of a step (two
  /// for each substep, and one), half a round trip each, then take a quarter of the step's time.
  double exchange_limit_s() const;
  /// True when every state is checked, and computed again where two bodies touched on two hosts.
  bool redoes() const;
  /// True when the run goes on after a death: it takes another node to keep the dead one's parts.
  bool recovers() const;
  /// Number of states from one cut to the next; 0: no cuts.
  core::Step checkpoint_steps() const;
  core::ControlRules control_rules() const;
  /// 64-bit hash of everything that all nodes of a run must agree on (scene, regions, time, tolerances, aura, physics).
  std::uint64_t agreement() const;
  /// 64-bit hash of what decides the bits of states on any map: the scene, and how physics computes it. Stored in saved
  /// worlds.
  std::uint64_t world_identity() const;
};

/// Everything that is wrong with a file, one message a line, each "file:line:column: field: ...".
class BadConfig : public std::runtime_error {
 public:
  explicit BadConfig(std::vector<std::string> errors);
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  std::vector<std::string> errors_;
};

/// Reads and validates a launch file and the scene it names. `overrides` are "key.path=value" as in --set; their
/// errors name the override. Throws BadConfig with every error found, not only the first.
Launch read_launch(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// Reads and validates a scene file alone.
core::Scene read_scene(const std::filesystem::path& file);

}  // namespace aurasim::config
