// What a program wants to be told of a world, state by state, and what it is told.
//
//   aurasim::client::Interest interest;
//   interest.patterns = {"crate*"};
//   interest.contacts = true;
//   aurasim::client::Observer observer = world.observe(interest);
//   const aurasim::client::Observation state = observer.next();
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <aurasim/bodies.h>
#include <aurasim/errors.h>

namespace aurasim::client {

/// With sides along the world's axes, m.
struct WorldBox {
  std::array<double, 3> low = {}, high = {};
};

/// Where a sensor's frame S is: in the frame of the body that carries it, or in the world.
struct Mount {
  std::optional<std::uint64_t> body;
  std::array<double, 3> position = {};            ///< m
  std::array<double, 4> rotation = {1, 0, 0, 0};  ///< quaternion w x y z
};

/// Rays from one point: a lidar. They go through the body that carries it.
struct RayFan {
  Mount mount;
  std::vector<double> directions;  ///< n x 3, in S; need not be of length 1
  double range_m = 0;              ///< up to 10 km
  std::int64_t every = 1;          ///< cast in states whose number is a multiple of it

  /// rows x columns rays, row by row from the lowest elevation to the highest, each from the first azimuth to the last,
  /// both included. Azimuth: from x to y; elevation: from there up; rad.
  AURASIM_API static std::vector<double> grid(double azimuth_from, double azimuth_to, int columns,
                                              double elevation_from = 0, double elevation_to = 0, int rows = 1);
};

/// Says which bodies have their origin in it; its carrier never is.
struct Trigger {
  Mount mount;
  std::array<double, 3> size = {};  ///< sides along the axes of S, m, with S in the middle; or
  double radius_m = 0;              ///< > 0: a ball around S
};

struct Interest {
  /// States whose number is a multiple of it. 0: only those in which the run stands, which all others include.
  std::uint32_t every = 1;
  // A body is told of for any of these reasons.
  bool all = false;
  std::vector<std::uint64_t> bodies;
  std::vector<std::string> patterns;  ///< of names of kinds of bodies: * ? [a-z]
  std::vector<WorldBox> boxes;        ///< its origin is in one
  bool contacts = false;              ///< of these bodies
  bool joints = false;                ///< likewise
  std::vector<RayFan> fans;
  std::vector<Trigger> triggers;
};

/// What presses on what, summed up over the step. n rows. Of bodies that sleep, none.
struct Contacts {
  std::vector<std::int64_t> a;    ///< n: body
  std::vector<std::int64_t> b;    ///< n: body with a higher id; -1 - the number of a static
  std::vector<double> positions;  ///< n x 3, m: where, on the average
  std::vector<double> normals;    ///< n x 3: from a to b
  std::vector<double> impulses;   ///< n: N s, along the normals

  std::size_t size() const { return a.size(); }
};

/// Joints with one coordinate. n rows.
struct Joints {
  std::vector<std::uint32_t> ids;  ///< n: index into RunInfo::joints
  std::vector<double> positions;   ///< n: rad or m, of the joint's body a from its body b
  std::vector<double> speeds;      ///< n: rad/s or m/s

  std::size_t size() const { return ids.size(); }
};

/// As RayFan::directions. n rows.
struct FanHits {
  static constexpr std::int64_t kNothing = std::numeric_limits<std::int64_t>::min();

  bool cast = false;                  ///< in this state; else without rows
  bool complete = false;              ///< all that could be in the way was known
  std::vector<std::int64_t> objects;  ///< n: body; -1 - the number of a static; kNothing
  std::vector<double> distances;      ///< n: m; infinite: nothing
  std::vector<double> positions;      ///< n x 3, m
  std::vector<double> normals;        ///< n x 3, of what was hit

  std::size_t size() const { return objects.size(); }
};

struct TriggerEvents {
  bool complete = false;                             ///< all that could be in it was known
  std::vector<std::uint64_t> inside, entered, left;  ///< bodies, ascending; since the observation before
};

/// One state.
struct Observation {
  Bodies bodies;  ///< those that were asked for; exact: nothing is missing
  /// How often the run has been put back. A state may come again, under a higher count: then the earlier one is void.
  std::uint32_t redo = 0;
  std::uint64_t skipped = 0;           ///< observations before this one that the program was too slow for
  std::vector<std::uint64_t> missing;  ///< bodies under way, of which no region has said where they were; ascending
  std::vector<std::uint32_t> silent;   ///< regions that have not told this state
  Contacts contacts;
  Joints joints;
  std::vector<FanHits> fans;            ///< as Interest::fans
  std::vector<TriggerEvents> triggers;  ///< as Interest::triggers
};

}  // namespace aurasim::client
