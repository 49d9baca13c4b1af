// What a program wants to observe of a world, state by state, and the observations that it receives.
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

/// Box with sides along the world's axes, m.
struct WorldBox {
  std::array<double, 3> low = {}, high = {};
};

/// Pose of a sensor's frame S: in the frame of the body that carries it, or in the world.
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

  /// Returns the directions of rows x columns rays, row by row from the lowest elevation to the highest, each row from
  /// the first azimuth to the last, both included. Azimuth: from x to y; elevation: from the x-y plane up; rad.
  AURASIM_API static std::vector<double> grid(double azimuth_from, double azimuth_to, int columns,
                                              double elevation_from = 0, double elevation_to = 0, int rows = 1);
};

/// A region of space that reports the bodies with their origin in it; never the body that carries it.
struct Trigger {
  Mount mount;
  std::array<double, 3> size = {};  ///< sides along the axes of S, m, with S in the middle; or
  double radius_m = 0;              ///< > 0: a ball around S
};

struct Interest {
  /// Observes states whose number is a multiple of it. 0: only states in which the run is paused. These are observed
  /// with any value.
  std::uint32_t every = 1;
  // A body is included for any of these reasons.
  bool all = false;
  std::vector<std::uint64_t> bodies;
  std::vector<std::string> patterns;  ///< patterns for names of prototypes: * ? [a-z]
  std::vector<WorldBox> boxes;        ///< boxes; a body is included when its origin is in one
  bool contacts = false;              ///< include contacts of these bodies
  bool joints = false;                ///< include joints of these bodies
  std::vector<RayFan> fans;
  std::vector<Trigger> triggers;
};

/// Contacts, summed up over the step. n rows. Sleeping bodies have none.
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

/// Hits of a ray fan. n rows, in the order of RayFan::directions.
struct FanHits {
  static constexpr std::int64_t kNothing = std::numeric_limits<std::int64_t>::min();

  bool cast = false;                  ///< the fan was cast in this state; false: no rows
  bool complete = false;              ///< everything that could be in the way was known
  std::vector<std::int64_t> objects;  ///< n: body; -1 - the number of a static; kNothing
  std::vector<double> distances;      ///< n: m; infinite: nothing
  std::vector<double> positions;      ///< n x 3, m
  std::vector<double> normals;        ///< n x 3, of what was hit

  std::size_t size() const { return objects.size(); }
};

struct TriggerEvents {
  bool complete = false;  ///< everything that could be in it was known
  /// Ids of bodies, ascending; entered and left: since the observation before.
  std::vector<std::uint64_t> inside, entered, left;
};

/// Observation of one state.
struct Observation {
  Bodies bodies;  ///< the requested bodies; exact: nothing is missing
  /// How often the run has been put back. A state may be observed again with a higher count, which makes the earlier
  /// observation void.
  std::uint32_t redo = 0;
  std::uint64_t skipped = 0;           ///< observations dropped before this one, because the program was too slow
  std::vector<std::uint64_t> missing;  ///< bodies being handed over whose place no region has published; ascending
  std::vector<std::uint32_t> silent;   ///< regions that have not sent this state
  Contacts contacts;
  Joints joints;
  std::vector<FanHits> fans;            ///< as Interest::fans
  std::vector<TriggerEvents> triggers;  ///< as Interest::triggers
};

}  // namespace aurasim::client
