// Networks that break and heal, in virtual time: afterwards there is one world, from a state that was kept, and never
// were there two. The number of random schedules: AURASIM_OUTAGES (default 400); one of them again:
// AURASIM_OUTAGE_SEED.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "outage_sim.h"

namespace aurasim::process::test {
namespace {

using namespace std::chrono_literals;
using Links = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// From the hosts of one side to those of the other, and back.
Links between(std::uint32_t hosts, std::uint32_t side) {
  Links links;
  for (std::uint32_t a = 0; a < hosts; ++a) {
    for (std::uint32_t b = 0; b < hosts; ++b) {
      if (((side >> a) & 1U) != ((side >> b) & 1U)) links.insert({a, b});
    }
  }
  return links;
}

Links all_of(std::uint32_t hosts) {
  Links links;
  for (std::uint32_t a = 0; a < hosts; ++a) {
    for (std::uint32_t b = 0; b < hosts; ++b) {
      if (a != b) links.insert({a, b});
    }
  }
  return links;
}

/// Only one direction, of one host.
Links deaf(std::uint32_t hosts, std::uint32_t host) {
  Links links;
  for (std::uint32_t other = 0; other < hosts; ++other) {
    if (other != host) links.insert({other, host});
  }
  return links;
}

Links mute(std::uint32_t hosts, std::uint32_t host) {
  Links links;
  for (const auto& [from, to] : deaf(hosts, host)) links.insert({to, from});
  return links;
}

class Outages : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kHosts = 4;
  static constexpr double kWithin = 10;

  /// An outage from 10 s on, for so long.
  void expect_one_world_after(const Links& links, double length_s, bool flaps = false) {
    OutageSim sim(kHosts, 1);
    sim.plan({at(10), at(10 + length_s), flaps, links});
    sim.run_until(at(10));
    const core::Step before = sim.newest_state();
    sim.run_until(at(10 + length_s + kWithin));
    EXPECT_EQ(sim.broken(), "") << sim.story();
    EXPECT_EQ(sim.problem(), "") << length_s << " s\n" << sim.story();
    for (const core::Step state : sim.went_back_to()) {
      EXPECT_GE(state, before - 3 * OutageSim::kCheckpointSteps) << length_s << " s\n" << sim.story();
    }
    const core::Step then = sim.newest_state();
    sim.run_until(at(10 + length_s + kWithin + 2));
    EXPECT_GT(sim.newest_state(), then) << sim.story();
  }
};

constexpr double kLengths[] = {1, 5, 9, 10, 11, 12, 15, 20, 30, 60};

TEST_F(Outages, OfEveryLink) {
  for (const double length : kLengths) expect_one_world_after(all_of(kHosts), length);
}

TEST_F(Outages, OfHalfTheHosts) {
  for (const std::uint32_t side : {0b0011U, 0b0101U, 0b1001U}) {
    for (const double length : kLengths) expect_one_world_after(between(kHosts, side), length);
  }
}

TEST_F(Outages, OfOneHost) {
  for (std::uint32_t host = 0; host < kHosts; ++host) {
    for (const double length : kLengths) expect_one_world_after(between(kHosts, 1U << host), length);
  }
}

TEST_F(Outages, BetweenTwoHostsThatOthersHear) {
  for (const double length : kLengths) expect_one_world_after({{0, 1}, {1, 0}}, length);
}

TEST_F(Outages, OfOneDirection) {
  for (std::uint32_t host = 0; host < kHosts; ++host) {
    for (const double length : kLengths) {
      expect_one_world_after(deaf(kHosts, host), length);
      expect_one_world_after(mute(kHosts, host), length);
    }
  }
}

TEST_F(Outages, OfLinksThatFlap) { expect_one_world_after(all_of(kHosts), 30, true); }

TEST_F(Outages, WhatTheMajorityHasDoneMeanwhileCounts) {
  OutageSim sim(kHosts, 1);
  sim.plan({at(10), at(100), false, between(kHosts, 0b1000U)});
  sim.run_until(at(60));
  EXPECT_NE(sim.story().find("process 5"), std::string::npos) << "another host takes region 3 over\n" << sim.story();
  const core::Step then = sim.newest_state();
  EXPECT_GT(then, 200) << sim.story();
  sim.run_until(at(112));
  EXPECT_EQ(sim.problem(), "") << sim.story();
  EXPECT_GT(sim.newest_state(), then);
}

/// Some outages of random kinds, begins and lengths, which may overlap, and now and then a death among them.
void expect_one_world_after_random_outages(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t n) { return static_cast<std::uint32_t>(random() % n); };
  const std::uint32_t hosts = 2 + below(5);
  OutageSim sim(hosts, seed);
  double healed_s = 0;
  for (std::uint32_t i = 0, count = 1 + below(4); i < count; ++i) {
    const double begin_s = 5 + 0.1 * below(400);
    const double length_s = std::pow(10.0, 0.001 * below(1800));  // 1 to 63 s
    const std::uint32_t host = below(hosts), other = (host + 1 + below(hosts - 1)) % hosts;
    Outage outage{at(begin_s), at(begin_s + length_s), below(8) == 0, {}};
    switch (below(6)) {
      case 0:
        outage.links = all_of(hosts);
        break;
      case 1:
        outage.links = between(hosts, below(1U << hosts));
        break;
      case 2:
        outage.links = between(hosts, 1U << host);
        break;
      case 3:
        outage.links = deaf(hosts, host);
        break;
      case 4:
        outage.links = mute(hosts, host);
        break;
      default:
        outage.links = {{host, other}, {other, host}};
        break;
    }
    sim.plan(outage);
    healed_s = std::max(healed_s, begin_s + length_s);
  }
  // The others' patience, and the time in which a second process begins.
  const bool dies = below(5) == 0 && hosts > 2;
  const double death_s = 5 + 0.1 * below(300);
  if (dies) sim.kill(below(hosts), at(death_s));
  if (dies) healed_s = std::max(healed_s, death_s);
  const double within_s = dies ? 60 : 10;
  core::Step newest = 0;
  for (double t = 5; t < healed_s + within_s; t += 5) {
    sim.run_until(at(std::min(t, healed_s + within_s)));
    newest = std::max(newest, sim.newest_state());
  }
  sim.run_until(at(healed_s + within_s));
  ASSERT_EQ(sim.broken(), "") << "seed " << seed << ", " << hosts << " hosts\n" << sim.story();
  ASSERT_EQ(sim.problem(), "") << "seed " << seed << ", " << hosts << " hosts, healed at " << healed_s << " s\n"
                               << sim.story();
  for (const core::Step state : sim.went_back_to()) {
    ASSERT_GT(state, 0) << "seed " << seed << ", " << hosts << " hosts\n" << sim.story();
  }
}

TEST(RandomOutages, LeaveOneWorld) {
  if (const char* const seed = std::getenv("AURASIM_OUTAGE_SEED")) {
    return expect_one_world_after_random_outages(std::strtoull(seed, nullptr, 10));
  }
  const char* const wanted = std::getenv("AURASIM_OUTAGES");
  const std::uint64_t count = wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : 400;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    expect_one_world_after_random_outages(seed);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace aurasim::process::test
