#include "node/recorder.h"

#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/os.h>
#include <nlohmann/json.hpp>

namespace aurasim::node {
namespace {

constexpr core::Step kFlushEvery = 60;
constexpr std::array<const char*, core::kViolationKinds> kKindNames = {"speed", "latency", "frame", "promise", "span"};

const char* name_of(core::HandOffReason reason) {
  return reason == core::HandOffReason::kAuraCollision ? "aura_collision" : "boundary_traversal";
}

}  // namespace

std::filesystem::path Recorder::region_folder(const std::filesystem::path& folder, core::RegionId region) {
  return folder / fmt::format("region_{}", core::value_of(region));
}

Recorder::Recorder(const std::filesystem::path& folder, core::RegionId region)
    : region_(region), folder_(region_folder(folder, region)) {
  std::filesystem::create_directories(folder_);
  std::filesystem::remove(folder_ / "node.json");
  steps_ =
      open("steps.csv",
           "region,step,frame_ms,wait_ms,physics_ms,protocol_ms,transport_ms,bodies,awake,foreign_auras,projecting,"
           "largest_cluster,hand_offs_out,hand_offs_in,violations\n");
  collisions_ = open("collisions.csv",
                     "region,step,body_a,body_b,penetration_m,relative_speed_m_s,penetration_time_s,late,missed,"
                     "violation_flagged\n");
  migrations_ = open("migrations.csv",
                     "region,direction,stamp,joined_step,body,epoch,source,destination,reason,reclaimed,touched\n");
  violations_ = open("violations.csv", "region,step,kind,of_region,body,value,allowed\n");
  births_ = open("births.csv", "region,body,birth_step\n");
  removals_ = open("removals.csv", "region,body,removed_step\n");
}

Recorder::~Recorder() = default;

Recorder::File Recorder::open(const char* name, const char* header) const {
  File file(std::fopen((folder_ / name).c_str(), "w"));
  if (!file) throw std::runtime_error(fmt::format("cannot write {}", (folder_ / name).string()));
  std::fputs(header, file.get());
  return file;
}

void Recorder::write(const StepReport& r, const FrameTimes& times, const Node& node) {
  fmt::print(steps_.get(), "{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{},{},{},{},{},{}\n",
             core::value_of(region_), r.step, times.frame_ms, times.wait_ms, 1e3 * r.durations.physics_s,
             1e3 * r.durations.protocol_s, 1e3 * r.durations.transport_s, r.bodies, r.awake, r.foreign_auras,
             r.projecting, r.largest_cluster, r.departures.size(), r.arrivals.size(),
             node.protocol().violations().total());
  write_hand_offs(r);
  write_collisions(r);
  for (const core::Violation& v : node.protocol().violations().recent()) {
    fmt::print(violations_.get(), "{},{},{},{},{},{:.6g},{:.6g}\n", core::value_of(region_), v.step,
               kKindNames[static_cast<std::size_t>(v.kind)], core::value_of(v.region), core::value_of(v.body), v.value,
               v.allowed);
  }
  for (const Birth& birth : r.births) {
    fmt::print(births_.get(), "{},{},{}\n", core::value_of(region_), core::value_of(birth.body), birth.birth);
  }
  if (!r.births.empty()) std::fflush(births_.get());  // rare, and nobody else knows of them
  for (const physics::Removal& removal : r.removals) {
    fmt::print(removals_.get(), "{},{},{}\n", core::value_of(region_), core::value_of(removal.body), removal.step);
  }
  if (!r.removals.empty()) std::fflush(removals_.get());
  for (const HashPart& part : r.hash) hash_[part.step] += part.sum;
  if (r.step >= flushed_ + kFlushEvery) {
    flush();
    flushed_ = r.step;
  }
}

void Recorder::write_settling(const StepReport& report) {
  write_hand_offs(report);
  for (const HashPart& part : report.hash) hash_[part.step] += part.sum;
}

void Recorder::write_hand_offs(const StepReport& report) {
  const auto row = [this](const char* direction, const HandOffRow& h) {
    fmt::print(migrations_.get(), "{},{},{},{},{},{},{},{},{},{},{}\n", core::value_of(region_), direction, h.stamp,
               h.joined, core::value_of(h.body), h.epoch, core::value_of(h.source), core::value_of(h.destination),
               name_of(h.reason), int{h.reclaimed}, int{h.touched});
  };
  for (const HandOffRow& h : report.departures) row("out", h);
  for (const HandOffRow& h : report.arrivals) row("in", h);
}

void Recorder::write_collisions(const StepReport& report) {
  for (const SeenCollision& s : report.collisions) {
    const physics::Collision& c = s.collision;
    const double time_s = c.relative_speed_m_s > 0 ? c.penetration_m / c.relative_speed_m_s : 0;
    fmt::print(collisions_.get(), "{},{},{},{},{:.6g},{:.6g},{:.6g},{},{},{}\n", core::value_of(region_), c.step,
               core::value_of(c.a), core::value_of(c.b), c.penetration_m, c.relative_speed_m_s, time_s, int{s.late},
               int{s.missed}, int{s.flagged});
  }
}

void Recorder::flush() {
  for (std::FILE* file : {steps_.get(), collisions_.get(), migrations_.get(), violations_.get(), births_.get()}) {
    std::fflush(file);
  }
}

void Recorder::finish(Node& node, const Ending& ending) {
  flush();
  const File hashes = open("state_hash.csv", "step,hash\n");
  for (const auto& [step, sum] : hash_) fmt::print(hashes.get(), "{},{:016x}\n", step, sum);
  write_bodies(node);
  write_summary(node, ending);
}

void Recorder::write_bodies(Node& node) const {
  const File bodies = open("bodies.csv", "region,body,epoch,birth_step,where,x_m,y_m,z_m,qw,qx,qy,qz\n");
  const auto row = [&](const core::BodyState& b, const char* where) {
    const core::Vec3& p = b.pose.p_WB;
    const core::Quat& q = b.pose.q_WB;
    fmt::print(bodies.get(), "{},{},{},{},{},{},{},{},{},{},{},{}\n", core::value_of(region_), core::value_of(b.id),
               b.epoch, b.birth, where, p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  };
  for (const core::BodyState& body : node.world().snapshot().bodies) row(body, "here");
  const auto under_way = [&](const core::HandOff& h) {
    for (const core::BodyRecord& body : h.cluster.bodies) row(core::state_of(body), "under_way");
  };
  for (const core::HandOff& h : node.protocol().departures().open()) under_way(h);
  for (const core::HandOff& h : node.protocol().intake().to_reclaim()) under_way(h);
}

void Recorder::write_summary(Node& node, const Ending& ending) const {
  const core::Protocol& p = node.protocol();
  nlohmann::json violations;
  for (int k = 0; k < core::kViolationKinds; ++k) {
    violations[kKindNames[static_cast<std::size_t>(k)]] = p.violations().count(static_cast<core::ViolationKind>(k));
  }
  nlohmann::json dead = nlohmann::json::array();
  for (const core::RegionId id : ending.dead_regions) dead.push_back(core::value_of(id));
  const nlohmann::json summary = {
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
  };
  std::ofstream(folder_ / "node.json") << summary.dump(2) << '\n';
}

}  // namespace aurasim::node
