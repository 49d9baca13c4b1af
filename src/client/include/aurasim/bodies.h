// The bodies and nodes of a run, as arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::client {

/// All bodies of one state, by columns: row i of each is of the same body. n rows, ascending by id. World frame.
struct Bodies {
  std::int64_t step = 0;         ///< number of the state
  double time_s = 0;             ///< simulated, since state 0
  std::uint32_t generation = 0;  ///< counts resets, other scenes and other regions
  /// True: every row is of this very state, as the nodes have it. False while the run goes on: `step` is then the
  /// newest state that all nodes had published, and a body that has moved by less than 0.1 mm since may have an older
  /// row.
  bool exact = false;

  std::vector<std::uint64_t> ids;         ///< n
  std::vector<double> positions;          ///< n x 3: x y z, m
  std::vector<float> rotations;           ///< n x 4: quaternion w x y z
  std::vector<float> linear_velocities;   ///< n x 3, m/s
  std::vector<float> angular_velocities;  ///< n x 3, rad/s
  std::vector<std::uint32_t> regions;     ///< n: region that hosts the body
  std::vector<std::uint32_t> epochs;      ///< n: how often it has changed host
  /// N: index into RunInfo::prototypes; higher indices are prototypes of clients.
  std::vector<std::uint32_t> prototypes;
  std::vector<std::uint8_t> asleep;  ///< n: 1: the body is asleep
  /// n: 1: the body is being handed over: in this state its former host no longer computes it, and its next host not
  /// yet. With `exact` its row is of this state all the same; otherwise the row may be of the state in which it left.
  std::vector<std::uint8_t> under_way;

  std::size_t size() const { return ids.size(); }
};

/// Status that a node publishes of itself, as `aurasim top` shows it.
struct NodeStatus {
  std::uint32_t region = 0;
  std::string state;  ///< starting, waiting, running, paused, finished, failed, recovering, spare, cut off, lost
  std::uint32_t pid = 0;
  std::int64_t step = 0;
  std::uint32_t generation = 0;
  std::uint64_t bodies = 0, awake = 0, foreign_auras = 0;
  std::uint64_t hand_offs_out = 0, hand_offs_in = 0;
  std::uint64_t violations = 0;         ///< broken promises since the start
  std::uint32_t redos = 0;              ///< how often states were put back and computed again
  std::uint64_t setpoints_heard = 0;    ///< messages of World::control received
  std::uint64_t setpoints_late = 0;     ///< those that came after their state had been computed
  std::uint64_t setpoints_refused = 0;  ///< refused messages, and setpoints that no body can bear
  double frame_ms_p50 = 0, frame_ms_p99 = 0;
  double real_time_factor = 0, rate = 1;
  std::vector<double> box;          ///< x0 y0 x1 y1 of its region, m; infinite sides
  std::vector<std::uint32_t> dead;  ///< regions that it has marked dead
  std::string text;                 ///< description of a problem; empty: none
};

struct RunInfo {
  std::string file;                          ///< launch file, absolute
  std::string scene;                         ///< name of the present scene
  std::string key;                           ///< name whose key is used; empty: an open run
  std::uint32_t domain = 0;                  ///< DDS domain
  double step_s = 0;                         ///< simulated time of a step
  double tick_hz = 0;                        ///< how often states are published while it runs
  std::int32_t lookahead = 0;                ///< K, in steps
  std::string sync;                          ///< free_running, bounded, deterministic
  std::vector<std::string> prototypes;       ///< names of the scene's kinds of bodies
  std::vector<std::string> joints;           ///< names of the scene's joints; their numbers are places in this list
  std::vector<std::vector<double>> regions;  ///< x0 y0 x1 y1 of each, m; infinite sides
};

}  // namespace aurasim::client
