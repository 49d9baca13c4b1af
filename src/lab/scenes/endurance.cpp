#include "lab/scenes/endurance.h"

#include <algorithm>
#include <deque>
#include <fstream>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "lab/scenes/play.h"

namespace aurasim::lab {
namespace {

constexpr core::Step kBetweenParts = 60;
constexpr core::Step kBetweenOrders = 45;
constexpr core::Step kOrderedAhead = 120;  // more than any map needs, even with many nodes
constexpr std::size_t kPartsKept = 4;
constexpr std::uint64_t kMostNewcomers = 8;
constexpr int kNodes[] = {4, 4, 4, 2, 9, 1};

std::uint64_t resident_kB() {
  std::uint64_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) / 1024;
}

core::RegionMap map_of(int nodes) {
  const std::size_t rows = nodes == 9 ? 3 : nodes == 4 ? 2 : 1;
  return core::RegionMap::grid(rows, static_cast<std::size_t>(nodes) / rows, 8, 8);
}

/// A client's request, and its state.
struct Wish {
  std::uint64_t request = 0;
  core::Step at_step = 0;
  core::Action action;
};

/// Hash sums over all bodies, of states that have not been compared yet.
using Hashes = std::map<core::Step, std::uint64_t>;

void note(const node::StepReport& report, Hashes& hashes) {
  for (const node::HashPart& part : report.hash) hashes[part.step] += part.sum;
}

void note_all(const VirtualCluster& cluster, Hashes& hashes) {
  for (std::size_t r = 0; r < cluster.size(); ++r) {
    for (const node::StepReport& report : cluster.node(r).confirmed()) note(report, hashes);
  }
}

class Endurance {
 public:
  Endurance(const config::Launch& launch, const EndurancePlan& plan, const std::atomic<bool>& stop)
      : launch_(launch), rules_(launch_rules(launch, plan.setup_of)), stop_(stop), random_(plan.seed) {
    rules_.hash_states = true;
    rules_.shortest_frame_s = 0.1 * launch.step_s();
    rules_.longest_frame_s = 0.9 * launch.step_s();
    rules_.network.latency_s = 0.1 * launch.step_s();
    rules_.network.jitter_s = 0.2 * launch.step_s();
    ClusterRules alone = rules_;
    alone.aura.redo = false;
    one_.emplace(launch.scene, core::RegionMap::columns(1, 1), alone);
    note_all(*one_, one_seen_);
    many_.emplace(launch.scene, map_of(4), rules_);
    recorded_.assign(many_->size(), -1);
    note_all(*many_, many_seen_);
  }

  /// Runs for some seconds, and then lets a node die or loads a saved world.
  void chapter() {
    const core::Step begin = many_->slowest();
    const core::Step last = (begin / kBetweenParts + 1 + draw(18)) * kBetweenParts + kBetweenParts;
    parts_.clear();
    for (core::Step n = (begin / kBetweenParts + 1) * kBetweenParts; n <= last; n += kBetweenParts) {
      for (std::size_t r = 0; r < many_->size(); ++r) many_->node(r).save(n);
    }
    if (draw(2) == 0) {
      die(last - draw(kBetweenParts));
    } else {
      load(last);
    }
  }

  bool has_failed() const { return !told_.failure.empty() || stop_; }

  Endured told() {
    told_.hours = static_cast<double>(told_.state) * launch_.step_s() / 3600;
    told_.resident_kB = resident_kB();
    return told_;
  }

 private:
  core::Step draw(core::Step below) { return static_cast<core::Step>(random_() % static_cast<std::uint64_t>(below)); }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }

  /// Lets a node die with its memory. The other nodes know the orders.
  void die(core::Step last) {
    const auto victim = static_cast<std::size_t>(draw(static_cast<core::Step>(many_->size())));
    run_until([&] { return many_->node(victim).current_step() >= last; });
    if (has_failed()) return;
    for (auto parts = parts_.rbegin(); parts != parts_.rend(); ++parts) {
      if (!is_complete(*parts)) continue;
      const core::WorldCut whole = core::merge(parts->second);
      std::vector<core::WorldCut> all = std::move(parts->second);
      ++told_.deaths;
      for (std::size_t r = 0; r < many_->size(); ++r) {
        if (r != victim) all.push_back(many_->node(r).orders_now(whole));
      }
      return go_on_from(core::merge(std::move(all)), static_cast<int>(many_->size()));
    }
    // No state has been kept since the chapter began, so no node dies in this one.
  }

  /// Saves the state to a file and goes on from it on other nodes.
  void load(core::Step state) {
    run_until([&] { return parts_.contains(state) && is_complete(*parts_.find(state)); });
    if (has_failed()) return;
    ++told_.loads;
    go_on_from(core::merge(std::move(parts_[state])), kNodes[draw(std::size(kNodes))]);
  }

  bool is_complete(const std::pair<const core::Step, std::vector<core::WorldCut>>& parts) const {
    return parts.second.size() == many_->size() &&
           *std::ranges::min_element(recorded_) >= parts.first + launch_.lookahead();
  }

  template <class Done>
  void run_until(Done done) {
    while (!done() && !has_failed()) {
      const core::Step newest = one_->slowest();
      while (many_->slowest() > one_->slowest()) step_alone();
      if (newest / kBetweenOrders != one_->slowest() / kBetweenOrders) wish();
      const VirtualCluster::Event event = many_->next();
      ++told_.computed;
      const std::size_t r = core::value_of(event.region);
      for (core::WorldCut& part : many_->node(r).take_saved()) parts_[part.step].push_back(std::move(part));
      if (parts_.size() > kPartsKept) parts_.erase(parts_.begin());
      for (const node::StepReport& report : many_->node(r).confirmed()) {
        note(report, many_seen_);
        recorded_[r] = std::max(recorded_[r], report.step);
      }
    }
  }

  void step_alone() {
    one_->next();
    note_all(*one_, one_seen_);
  }

  void go_on_from(core::WorldCut whole, int nodes) {
    const core::WorldCut world = through_a_file(std::move(whole));
    while (one_->slowest() < world.step) step_alone();
    compare_until(world.step);
    told_.bodies = core::body_count(world);
    many_seen_.clear();
    many_.reset();
    many_.emplace(launch_.scene, map_of(nodes), rules_, &world, node::Recorded::kYes);
    recorded_.assign(many_->size(), world.step);
    note_all(*many_, many_seen_);
    parts_.clear();
    std::erase_if(wishes_, [&](const Wish& wish) { return wish.at_step <= world.step; });
    for (const Wish& wish : wishes_) {
      const auto is_it = [&](const core::Order& order) { return order.request == wish.request; };
      if (std::ranges::none_of(world.orders, is_it)) order(*many_, wish);
    }
  }

  void compare_until(core::Step step) {
    for (; compared_ <= step && told_.failure.empty(); ++compared_) {
      if (one_seen_[compared_] != many_seen_[compared_]) {
        told_.failure = fmt::format("state {} has other bits than on one node", compared_);
      }
      ++told_.compared;
    }
    told_.state = step;
    one_seen_.erase(one_seen_.begin(), one_seen_.upper_bound(step));
  }

  /// Requests an impulse, a new body, or a removal, in a state so far ahead that both runs can still execute it.
  void wish() {
    Wish wish{++requests_, one_->slowest() + kOrderedAhead, {}};
    const bool is_kick = !one_->records(0).empty() && draw(4) != 0;
    wish.action = is_kick ? kick() : newcomers_.size() < kMostNewcomers ? come() : go();
    order(*one_, wish);
    order(*many_, wish);
    wishes_.push_back(std::move(wish));
    ++told_.orders;
  }

  static void order(VirtualCluster& cluster, const Wish& wish) {
    const core::Order& given = cluster.node(0).order(wish.action, wish.request, wish.at_step);
    if (given.at_step != wish.at_step) throw std::logic_error("an order comes too late for one of the two runs");
  }

  /// An impulse on any body, towards the middle, because the body would otherwise leave the scene within the hour.
  core::Action kick() {
    const std::span<const core::BodyRecord> all = one_->records(0);
    const core::BodyRecord& body = all[static_cast<std::size_t>(draw(std::ssize(all)))];
    core::Vec3 v_W(uniform(-3, 3), uniform(-3, 3), uniform(0, 4));
    const core::Vec3 home_W(-body.p_WB.x(), -body.p_WB.y(), 0);
    if (home_W.norm() > 1) v_W += 4 * home_W.normalized();
    return core::SetVelocity{body.id, v_W, {}};
  }

  core::Action come() {
    core::Spawn spawn;
    spawn.id = core::BodyId{core::kFirstClientBody + requests_};
    spawn.prototype = core::PrototypeId{static_cast<std::uint32_t>(draw(std::ssize(launch_.scene.prototypes)))};
    spawn.pose.p_WB = {uniform(-6, 6), uniform(-6, 6), uniform(6, 12)};
    newcomers_.push_back(spawn.id);
    return spawn;
  }

  core::Action go() {
    const core::BodyId id = newcomers_.front();
    newcomers_.pop_front();
    return core::RemoveBody{id};
  }

  const config::Launch& launch_;
  ClusterRules rules_;
  const std::atomic<bool>& stop_;
  std::mt19937_64 random_;
  std::optional<VirtualCluster> one_, many_;
  Hashes one_seen_, many_seen_;
  std::vector<core::Step> recorded_;  ///< by region of `many_`
  std::map<core::Step, std::vector<core::WorldCut>> parts_;
  core::Step compared_ = 0;  ///< the next state
  std::uint64_t requests_ = 0;
  std::deque<Wish> wishes_;  ///< requests that may have to be repeated
  std::deque<core::BodyId> newcomers_;
  Endured told_;
};

}  // namespace

Endured endure(const config::Launch& launch, const EndurancePlan& plan, const std::function<void(const Endured&)>& tell,
               const std::atomic<bool>& stop) {
  Endurance run(launch, plan, stop);
  Endured now = run.told();
  tell(now);
  double next_h = plan.told_every_h;
  while (now.hours < plan.hours && !run.has_failed()) {
    run.chapter();
    now = run.told();
    if (now.hours < next_h) continue;
    next_h += plan.told_every_h;
    tell(now);
  }
  tell(now);
  return now;
}

}  // namespace aurasim::lab
