#include "lab/real_cluster.h"

#include <algorithm>
#include <barrier>
#include <chrono>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "dds/dds_transport.h"
#include "lab/pair.h"

namespace aurasim::lab {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr auto kPatience = 20s;
constexpr auto kStartsIn = 40ms;
/// Time by which a thread wakes up too late, seconds. Without it, a frame as long as the tolerance would exceed it.
constexpr double kOversleeps_s = 0.0005;

/// Holds back a step's messages until its frame is over.
class FrameEnd final : public transport::Transport {
 public:
  explicit FrameEnd(transport::Transport& below) : below_(below) {}

  void take(core::Inbox& inbox) override { below_.take(inbox); }
  void send(const core::Outbox& outbox) override { held_ = outbox; }
  void wait_for_arrival(std::chrono::nanoseconds time_out) override { below_.wait_for_arrival(time_out); }
  void leave() {
    if (held_) below_.send(*held_);
    held_.reset();
  }

 private:
  transport::Transport& below_;
  std::optional<core::Outbox> held_;
};

dds::Settings dds_settings(const RealNetwork& network, std::uint32_t region) {
  dds::Settings settings;
  settings.domain = network.domain;
  settings.profiles = network.profiles;
  settings.interfaces = {"127.0.0.1"};
  settings.impairment.delay_s = network.latency_s;
  settings.impairment.loss = network.loss;
  settings.impairment.seed = network.seed;
  settings.impairment_stream = region;
  return settings;
}

dds::TransportSettings transport_settings(const core::RegionMap& map, core::RegionId region) {
  dds::TransportSettings settings;
  settings.region = region;
  settings.neighbours = map.neighbours(region, kEverywhere_m);
  settings.map_version = map.version();
  settings.region_count = static_cast<std::uint32_t>(map.size());
  return settings;
}

}  // namespace

struct RealCluster::Member {
  Member(const core::RegionMap& map, const RealNetwork& network, core::RegionId region)
      : participant(dds_settings(network, core::value_of(region))),
        wire(participant, transport_settings(map, region)),
        held(wire) {}

  /// Steps the node until state `last`. Throws std::runtime_error when messages of neighbours do not come.
  void drive(node::Node& node, const ClusterRules& rules, Clock::time_point epoch, core::Step last);
  void wait_until_due(node::Node& node, Clock::time_point due);
  void note(const node::Node& node, const node::StepReport& report);

  dds::Participant participant;
  dds::DdsTransport wire;
  FrameEnd held;
  Course course;
  std::exception_ptr failure;
};

void RealCluster::Member::wait_until_due(node::Node& node, Clock::time_point due) {
  const auto give_up = Clock::now() + kPatience;
  for (auto now = Clock::now(); now < due; now = Clock::now()) {
    participant.progress();
    held.wait_for_arrival(std::min<std::chrono::nanoseconds>(due - now, 2ms));
  }
  while (!node.ready()) {
    if (Clock::now() > give_up) {
      throw std::runtime_error(fmt::format("region {} waits for its neighbours in state {}",
                                           core::value_of(node.region()), node.current_step()));
    }
    held.wait_for_arrival(2ms);
  }
}

void RealCluster::Member::note(const node::Node& node, const node::StepReport& report) {
  const core::ViolationLog& violations = node.protocol().violations();
  course.promises.push_back({violations.total(), violations.count(core::ViolationKind::kLatency)});
  course.contacts.insert(course.contacts.end(), report.collisions.begin(), report.collisions.end());
  course.departures.insert(course.departures.end(), report.departures.begin(), report.departures.end());
}

void RealCluster::Member::drive(node::Node& node, const ClusterRules& rules, Clock::time_point epoch, core::Step last) {
  const std::size_t region = core::value_of(node.region());
  const double phase_s = region < rules.phase_s.size() ? rules.phase_s[region] : 0;
  Chance chance(rules.seed + region);
  Clock::time_point free = epoch;
  Seconds lag{0};
  while (node.current_step() < last) {
    const double due_s = static_cast<double>(node.current_step() + 1) * rules.aura.step_s + phase_s;
    const auto due = epoch + std::chrono::duration_cast<Clock::duration>(Seconds(due_s));
    wait_until_due(node, std::max(due, free));
    const auto begin = Clock::now();
    lag = begin - due;
    const double frame_s = chance.between(rules.shortest_frame_s, rules.longest_frame_s) - kOversleeps_s;
    note(node, node.step());
    std::this_thread::sleep_until(begin + Seconds(frame_s));
    free = Clock::now();
    node.protocol().report_frame(node.current_step(), Seconds(free - begin).count());
    held.leave();
  }
  course.slow_down = 1 + std::max(0.0, lag.count()) / (static_cast<double>(last) * rules.aura.step_s);
}

RealCluster::RealCluster(const core::RegionMap& map, const RealNetwork& network) : map_(map) {
  for (std::uint32_t r = 0; r < map_.size(); ++r) {
    members_.push_back(std::make_unique<Member>(map_, network, core::RegionId{r}));
  }
  for (const auto& member : members_) member->wire.wait_until_matched(kPatience);
}

RealCluster::~RealCluster() = default;

std::vector<Course> RealCluster::run(const core::Scene& scene, const ClusterRules& rules, core::Step last) {
  node::NodeSetup setup = node_setup(rules);
  setup.protocol.generation = ++generation_;
  Clock::time_point epoch;  // named when all nodes are there
  std::barrier all_there(static_cast<std::ptrdiff_t>(members_.size()),
                         [&epoch]() noexcept { epoch = Clock::now() + kStartsIn; });
  {
    std::vector<std::jthread> threads;
    for (std::uint32_t r = 0; r < members_.size(); ++r) {
      Member& member = *members_[r];
      member.course = {};
      member.failure = nullptr;
      threads.emplace_back([&, own = setup, r]() mutable {
        try {
          own.protocol.self = core::RegionId{r};
          node::Node node(own, scene, map_, member.held);
          member.note(node, node.start());
          member.held.leave();
          all_there.arrive_and_wait();
          member.drive(node, rules, epoch, last);
        } catch (...) {
          member.failure = std::current_exception();
        }
        all_there.arrive_and_drop();
      });
    }
  }
  std::vector<Course> courses;
  for (const auto& member : members_) {
    if (member->failure) std::rethrow_exception(member->failure);
    courses.push_back(std::move(member->course));
  }
  return courses;
}

}  // namespace aurasim::lab
