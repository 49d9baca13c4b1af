// The rows of a report's files. The recorder of a node writes them; the launcher merges and reads them (report.h).
// Units are in the names of the columns.
#pragma once

#include <cstdint>
#include <string_view>
#include <tuple>

#include "core/ids.h"
#include "records/csv.h"

namespace aurasim::records {

/// steps.csv: one step of one region.
struct StepRow {
  core::RegionId region{};
  core::Step step = 0;
  double frame_ms = 0;
  double wait_ms = 0;
  double physics_ms = 0;
  double protocol_ms = 0;
  double transport_ms = 0;
  double cut_ms = 0;   ///< keeping the state, to go back to it or to save it
  double hash_ms = 0;  ///< hashing the state
  std::uint64_t bodies = 0;
  std::uint64_t awake = 0;
  std::uint64_t foreign_auras = 0;
  std::uint64_t projecting = 0;
  std::uint64_t largest_cluster = 0;
  std::uint64_t hand_offs_out = 0;  ///< bodies
  std::uint64_t hand_offs_in = 0;
  std::uint64_t violations = 0;  ///< since the start

  static constexpr auto columns() {
    constexpr std::string_view kTime = "{:.4f}";
    return std::tuple{Column{"region", &StepRow::region},
                      Column{"step", &StepRow::step},
                      Column{"frame_ms", &StepRow::frame_ms, kTime},
                      Column{"wait_ms", &StepRow::wait_ms, kTime},
                      Column{"physics_ms", &StepRow::physics_ms, kTime},
                      Column{"protocol_ms", &StepRow::protocol_ms, kTime},
                      Column{"transport_ms", &StepRow::transport_ms, kTime},
                      Column{"cut_ms", &StepRow::cut_ms, kTime},
                      Column{"hash_ms", &StepRow::hash_ms, kTime},
                      Column{"bodies", &StepRow::bodies},
                      Column{"awake", &StepRow::awake},
                      Column{"foreign_auras", &StepRow::foreign_auras},
                      Column{"projecting", &StepRow::projecting},
                      Column{"largest_cluster", &StepRow::largest_cluster},
                      Column{"hand_offs_out", &StepRow::hand_offs_out},
                      Column{"hand_offs_in", &StepRow::hand_offs_in},
                      Column{"violations", &StepRow::violations}};
  }
};

/// collisions.csv: a first contact, or an overlap, as one region saw it.
struct CollisionRow {
  core::RegionId region{};
  core::Step step = 0;
  core::BodyId body_a{};
  core::BodyId body_b{};
  double penetration_m = 0;
  double relative_speed_m_s = 0;
  double penetration_time_s = 0;
  bool late = false;
  bool missed = false;
  bool violation_flagged = false;

  static constexpr auto columns() {
    constexpr std::string_view kNumber = "{:.6g}";
    return std::tuple{Column{"region", &CollisionRow::region},
                      Column{"step", &CollisionRow::step},
                      Column{"body_a", &CollisionRow::body_a},
                      Column{"body_b", &CollisionRow::body_b},
                      Column{"penetration_m", &CollisionRow::penetration_m, kNumber},
                      Column{"relative_speed_m_s", &CollisionRow::relative_speed_m_s, kNumber},
                      Column{"penetration_time_s", &CollisionRow::penetration_time_s, kNumber},
                      Column{"late", &CollisionRow::late},
                      Column{"missed", &CollisionRow::missed},
                      Column{"violation_flagged", &CollisionRow::violation_flagged}};
  }
};

/// migrations.csv: a body's change of host, as its sender or its receiver saw it.
struct MigrationRow {
  static constexpr std::string_view kOut = "out", kIn = "in";
  static constexpr std::string_view kAuraCollision = "aura_collision", kBoundaryTraversal = "boundary_traversal";

  core::RegionId region{};
  std::string_view direction;
  core::Step stamp = 0;
  core::Step joined_step = 0;  ///< 0 in the sender's rows
  core::BodyId body{};
  core::Epoch epoch = 0;
  core::RegionId source{};
  core::RegionId destination{};
  std::string_view reason;
  bool touched = false;  ///< known to the sender

  static constexpr auto columns() {
    return std::tuple{Column{"region", &MigrationRow::region}, Column{"direction", &MigrationRow::direction},
                      Column{"stamp", &MigrationRow::stamp},   Column{"joined_step", &MigrationRow::joined_step},
                      Column{"body", &MigrationRow::body},     Column{"epoch", &MigrationRow::epoch},
                      Column{"source", &MigrationRow::source}, Column{"destination", &MigrationRow::destination},
                      Column{"reason", &MigrationRow::reason}, Column{"touched", &MigrationRow::touched}};
  }
};

/// violations.csv: a broken promise, as one region saw it.
struct ViolationRow {
  core::RegionId region{};
  core::Step step = 0;
  std::string_view kind;
  core::RegionId of_region{};
  core::BodyId body{};
  double value = 0;
  double allowed = 0;

  static constexpr auto columns() {
    constexpr std::string_view kNumber = "{:.6g}";
    return std::tuple{Column{"region", &ViolationRow::region},
                      Column{"step", &ViolationRow::step},
                      Column{"kind", &ViolationRow::kind},
                      Column{"of_region", &ViolationRow::of_region},
                      Column{"body", &ViolationRow::body},
                      Column{"value", &ViolationRow::value, kNumber},
                      Column{"allowed", &ViolationRow::allowed, kNumber}};
  }
};

/// births.csv: a body's first host.
struct BirthRow {
  core::RegionId region{};
  core::BodyId body{};
  core::Step birth_step = 0;

  static constexpr auto columns() {
    return std::tuple{Column{"region", &BirthRow::region}, Column{"body", &BirthRow::body},
                      Column{"birth_step", &BirthRow::birth_step}};
  }
};

/// removals.csv: a body that an order took out.
struct RemovalRow {
  core::RegionId region{};
  core::BodyId body{};
  core::Step removed_step = 0;

  static constexpr auto columns() {
    return std::tuple{Column{"region", &RemovalRow::region}, Column{"body", &RemovalRow::body},
                      Column{"removed_step", &RemovalRow::removed_step}};
  }
};

/// bodies.csv: where a body was when a region's run ended.
struct BodyRow {
  static constexpr std::string_view kHere = "here", kUnderWay = "under_way";

  core::RegionId region{};
  core::BodyId body{};
  core::Epoch epoch = 0;
  core::Step birth_step = 0;
  std::string_view where;
  double x_m = 0, y_m = 0, z_m = 0;
  double qw = 1, qx = 0, qy = 0, qz = 0;

  static constexpr auto columns() {
    return std::tuple{Column{"region", &BodyRow::region}, Column{"body", &BodyRow::body},
                      Column{"epoch", &BodyRow::epoch},   Column{"birth_step", &BodyRow::birth_step},
                      Column{"where", &BodyRow::where},   Column{"x_m", &BodyRow::x_m},
                      Column{"y_m", &BodyRow::y_m},       Column{"z_m", &BodyRow::z_m},
                      Column{"qw", &BodyRow::qw},         Column{"qx", &BodyRow::qx},
                      Column{"qy", &BodyRow::qy},         Column{"qz", &BodyRow::qz}};
  }
};

/// state_hash.csv: a region's part of a state's hash, or the sum of all parts.
struct HashRow {
  core::Step step = 0;
  Hex64 hash{};

  static constexpr auto columns() { return std::tuple{Column{"step", &HashRow::step}, Column{"hash", &HashRow::hash}}; }
};

}  // namespace aurasim::records
