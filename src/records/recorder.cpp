#include "records/recorder.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "records/report_rows.h"
#include "records/setpoint_record.h"

namespace aurasim::records {
namespace {

constexpr core::Step kFlushEvery = 60;
constexpr std::size_t kLastWordBytes = 8 * 1024;
constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max() / 2;  ///< above the step of any row
constexpr std::array<const char*, core::kViolationKinds> kKindNames = {"speed", "latency", "frame", "promise", "span"};

std::string_view name_of(core::HandOffReason reason) {
  return reason == core::HandOffReason::kAuraCollision ? MigrationRow::kAuraCollision
                                                       : MigrationRow::kBoundaryTraversal;
}

/// Creates the region's folder with a node.json that says "died", as a killed node would leave it. It reserves room for
/// the longer final node.json.
std::filesystem::path make_folder(const std::filesystem::path& folder, core::RegionId region) {
  std::filesystem::create_directories(folder);
  const nlohmann::json died = {{"region", core::value_of(region)}, {"outcome", "died"}};
  reserve(folder / "node.json", died.dump(), kLastWordBytes);
  return folder;
}

/// Keeps the rows of states up to `after`, which stand in column `column`. Without `after` no rows are kept.
std::optional<RowFile::Keep> up_to(std::optional<core::Step> after, std::size_t column) {
  if (!after) return {};
  return RowFile::Keep{static_cast<std::uint64_t>(*after), [column](std::span<const std::string_view> cells) {
                         return cells.size() > column ? whole(cells[column]) : kNever;
                       }};
}

/// As up_to(), for migrations.csv. For a body that came, the state in which it first took part counts.
std::optional<RowFile::Keep> moves_up_to(std::optional<core::Step> after) {
  if (!after) return {};
  return RowFile::Keep{static_cast<std::uint64_t>(*after), [](std::span<const std::string_view> cells) {
                         return cells.size() > 3 ? whole(cells[cells[1] == "out" ? 2 : 3]) : kNever;
                       }};
}

}  // namespace

std::filesystem::path Recorder::region_folder(const std::filesystem::path& folder, core::RegionId region) {
  return folder / fmt::format("region_{}", core::value_of(region));
}

Recorder::Recorder(const std::filesystem::path& folder, core::RegionId region, std::optional<core::Step> after)
    : region_(region),
      folder_(make_folder(region_folder(folder, region), region)),
      steps_(folder_ / "steps.csv", csv_header<StepRow>(), up_to(after, 1)),
      collisions_(folder_ / "collisions.csv", csv_header<CollisionRow>(), up_to(after, 1)),
      migrations_(folder_ / "migrations.csv", csv_header<MigrationRow>(), moves_up_to(after)),
      violations_(folder_ / "violations.csv", csv_header<ViolationRow>(), up_to(after, 1)),
      births_(folder_ / "births.csv", csv_header<BirthRow>(), up_to(after, 2)),
      removals_(folder_ / "removals.csv", csv_header<RemovalRow>(), up_to(after, 2)),
      hashes_(folder_ / "state_hash.csv", csv_header<HashRow>(), up_to(after, 0)),
      setpoints_(folder_ / kSetpointsFile, std::string(kSetpointsHeader), up_to(after, 1)),
      flushed_(after.value_or(0)) {}

void Recorder::write(const node::StepReport& r, const FrameTimes& times) {
  if (r.put_back_from) return note_redo(r);
  if (end_) return;
  if (r.step <= last_) return write_settling(r);  // bodies that have joined since
  last_ = r.step;
  write_step(r, times);
  write_settling(r);
  write_collisions(r);
  write_violations(r);
  for (const node::Birth& birth : r.births) {
    births_.add(csv_line(BirthRow{region_, birth.body, birth.birth}));
  }
  for (const physics::Removal& removal : r.removals) {
    removals_.add(csv_line(RemovalRow{region_, removal.body, removal.step}));
  }
  // Births and removals are flushed at once: they are rare, and no other record has them.
  if (!r.births.empty() && !births_.flush()) end_records(births_);
  if (!r.removals.empty() && !removals_.flush()) end_records(removals_);
  if (r.step >= flushed_ + kFlushEvery) flush(r.step);
}

void Recorder::write_step(const node::StepReport& r, const FrameTimes& times) {
  StepRow row;
  row.region = region_;
  row.step = r.step;
  row.frame_ms = times.frame_ms;
  row.wait_ms = times.wait_ms;
  row.physics_ms = 1e3 * r.durations.physics_s;
  row.protocol_ms = 1e3 * r.durations.protocol_s;
  row.transport_ms = 1e3 * r.durations.transport_s;
  row.cut_ms = 1e3 * r.durations.cut_s;
  row.hash_ms = 1e3 * r.durations.hash_s;
  row.bodies = r.bodies;
  row.awake = r.awake;
  row.foreign_auras = r.foreign_auras;
  row.projecting = r.projecting;
  row.largest_cluster = r.largest_cluster;
  row.hand_offs_out = r.departures.size();
  row.hand_offs_in = r.arrivals.size();
  row.violations = r.violations_total;
  steps_.add(csv_line(row));
}

/// Writes rows of a state that is recorded already. A state's hash comes in parts, because bodies that join later have
/// made up that state, too. The merge adds the parts up.
void Recorder::write_settling(const node::StepReport& report) {
  if (end_) return;
  write_hand_offs(report);
  for (const core::BodyEffect& effect : report.effects.bodies) setpoints_.add(setpoint_row(region_, effect));
  for (const core::JointEffect& effect : report.effects.joints) setpoints_.add(setpoint_row(region_, effect));
  for (const core::StaticEffect& effect : report.effects.statics) setpoints_.add(setpoint_row(region_, effect));
  for (const node::HashPart& part : report.hash) hashes_.add(csv_line(HashRow{part.step, Hex64{part.sum}}));
}

void Recorder::write_hand_offs(const node::StepReport& report) {
  const auto row = [this](std::string_view direction, const node::HandOffRow& h) {
    migrations_.add(csv_line(MigrationRow{region_, direction, h.stamp, h.joined, h.body, h.epoch, h.source,
                                          h.destination, name_of(h.reason), h.touched}));
  };
  for (const node::HandOffRow& h : report.departures) row(MigrationRow::kOut, h);
  for (const node::HandOffRow& h : report.arrivals) row(MigrationRow::kIn, h);
}

void Recorder::write_collisions(const node::StepReport& report) {
  for (const node::SeenCollision& s : report.collisions) {
    const physics::Collision& c = s.collision;
    const double time_s = c.relative_speed_m_s > 0 ? c.penetration_m / c.relative_speed_m_s : 0;
    collisions_.add(csv_line(CollisionRow{region_, c.step, c.a, c.b, c.penetration_m, c.relative_speed_m_s, time_s,
                                          s.late, s.missed, s.flagged}));
  }
}

/// Notes a redo. The state is recorded already; the bodies that had joined later have joined anew.
void Recorder::note_redo(const node::StepReport& report) {
  redos_.push_back({*report.put_back_from, report.step, report.put_back_for});
  write_settling(report);
}

void Recorder::write_violations(const node::StepReport& report) {
  for (const core::Violation& v : report.violations) {
    violations_.add(csv_line(ViolationRow{region_, v.step, kKindNames[static_cast<std::size_t>(v.kind)], v.region,
                                          v.body, v.value, v.allowed}));
  }
}

void Recorder::flush(core::Step step) {
  for (RowFile* file :
       {&steps_, &collisions_, &migrations_, &violations_, &births_, &removals_, &hashes_, &setpoints_}) {
    if (!file->flush()) return end_records(*file);
  }
  flushed_ = step;
}

/// Ends the records after a failed write. The run goes on without them.
void Recorder::end_records(const RowFile& failed) {
  if (!end_) end_ = RecordsEnd{flushed_, failed.failure()};
}

void Recorder::secure() {
  if (!end_) flush(std::max(last_, flushed_));
}

void Recorder::finish(node::Node& node, const Ending& ending) {
  if (!end_) flush(node.current_step());
  try {
    write_bodies(node);
  } catch (const std::runtime_error& error) {
    if (!end_) end_ = RecordsEnd{flushed_, error.what()};
  }
  write_summary(node, ending);
}

void Recorder::write_bodies(node::Node& node) {
  RowFile bodies(folder_ / "bodies.csv", csv_header<BodyRow>());
  const auto row = [&](const core::BodyState& b, std::string_view where) {
    const core::Vec3& p = b.pose.p_WB;
    const core::Quat& q = b.pose.q_WB;
    bodies.add(
        csv_line(BodyRow{region_, b.id, b.epoch, b.birth, where, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}));
  };
  const node::BodiesAtEnd end = node.bodies_at_end();
  for (const core::BodyState& body : end.here) row(body, BodyRow::kHere);
  for (const core::BodyState& body : end.under_way) row(body, BodyRow::kUnderWay);
  if (!bodies.flush()) end_records(bodies);
}

void Recorder::write_summary(node::Node& node, const Ending& ending) const {
  const core::Protocol& p = node.protocol();
  nlohmann::json violations;
  for (int k = 0; k < core::kViolationKinds; ++k) {
    violations[kKindNames[static_cast<std::size_t>(k)]] = p.violations().count(static_cast<core::ViolationKind>(k));
  }
  nlohmann::json dead = nlohmann::json::array();
  for (const core::RegionId id : ending.dead_regions) dead.push_back(core::value_of(id));
  nlohmann::json summary = {
      {"region", core::value_of(region_)},
      {"outcome", ending.outcome},
      {"steps", node.current_step()},
      {"real_time_factor", ending.real_time_factor},
      {"violations", violations},
      {"late_collisions", node.collision_watch().late()},
      {"missed_collisions", node.collision_watch().missed()},
      {"late_without_violation", node.collision_watch().unflagged()},
      {"severed_contacts", node.world().severed_contacts()},
      {"auras_created", p.projection().counters().created},
      {"auras_updated", p.projection().counters().updated},
      {"auras_deleted", p.projection().counters().deleted},
      {"duplicate_messages", p.intake().counters().copies},
      {"messages_of_non_neighbours", p.intake().counters().strangers},
      {"let_go", p.counters().let_go},
      {"stale_arrivals", p.counters().stale_arrivals},
      {"dead_regions", dead},
      {"sent_bytes", ending.sent_bytes},
      {"checkpoint_bytes", ending.checkpoint_bytes},
      {"checkpoints_left_out", ending.checkpoints_left_out},
  };
  summary["exchange"] = ending.exchange;
  if (ending.round_trip_ms > 0) summary["round_trip_ms"] = ending.round_trip_ms;
  if (const TimeHistogram& times = ending.exchanges.times; times.count() > 0) {
    summary["exchanges"] = {{"count", times.count()},
                            {"p50_ms", 1e3 * times.percentile_s(0.5)},
                            {"p90_ms", 1e3 * times.percentile_s(0.9)},
                            {"p99_ms", 1e3 * times.percentile_s(0.99)},
                            {"max_ms", 1e3 * times.longest_s()},
                            {"asked", ending.exchanges.asked},
                            {"repeated", ending.exchanges.repeated}};
  }
  summary["computing_s"] = node.time_spent().all_s();
  summary["in_redos_s"] = node.time_spent().in_redos_s();
  constexpr std::size_t kMostPairs = 16;
  summary["redos"] = nlohmann::json::array();
  for (const Redo& redo : redos_) {
    nlohmann::json pairs = nlohmann::json::array();
    for (const core::TogetherPair& pair : redo.pairs) {
      if (pairs.size() < kMostPairs) pairs.push_back({core::value_of(pair.a), core::value_of(pair.b)});
    }
    summary["redos"].push_back({{"from_step", redo.from}, {"to_step", redo.to}, {"pairs", pairs}});
  }
  if (end_) summary["records_end"] = {{"after_step", end_->after}, {"why", end_->why}};
  overwrite(folder_ / "node.json", summary.dump(2) + '\n');
}

}  // namespace aurasim::records
