// When coupled regions send and await movers within a sweep: soft/patches.h.
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "physics/soft/exchange.h"
#include "physics/soft/patches.h"
#include "physics/soft/threads.h"

namespace aurasim::physics::testing {
namespace {

using ::testing::ElementsAre;

constexpr double kStep_s = 1. / 60;
constexpr std::size_t kStages = 4;
/// Each has one contact of two bodies that approach each other.
constexpr std::array<SoftStage, kStages> kOrder = {SoftStage::kInside, SoftStage::kCorners, SoftStage::kInsideEarly,
                                                   SoftStage::kCornersEarly};

/// Bodies 2i + 1 and 2i + 2 touch; what of it is solved shows in their speeds.
class Sweep : public SoftExchange {
 public:
  Sweep() {
    patches_.clear(movers_.size(), kStages);
    for (std::size_t i = 0; i < kStages; ++i) {
      const auto a = static_cast<std::int32_t>(2 * i + 1);
      movers_[2 * i + 1].v[0] = 1, movers_[2 * i + 2].v[0] = -1;
      touching_[i].count = 1;
      touching_[i].normal[0] = 1;
      patches_.put(i, touching_[i], a, a + 1, kOrder[i], 0);
    }
    std::vector<SoftInertia> inertias(movers_.size());
    for (SoftInertia& inertia : inertias) inertia.inv_mass = 1;
    patches_.build(movers_.data(), inertias.data(), {0, 0, 0}, team_);
  }

  void run() {
    const soft::Substep substep{.per_s = 8 / soft::Real(kStep_s), .top_push_m_s = 1, .pushes = true};
    team_.side_by_side([&](const soft::Worker& worker) { patches_.solve(movers_.data(), substep, this, worker); });
  }
  std::vector<std::string> said;

 private:
  void post(SoftPhase phase, bool, const soft::Mover*) override { say("post", phase); }
  void fetch(SoftPhase phase, bool, soft::Mover*) override { say("fetch", phase); }
  void say(const char* what, SoftPhase phase) {
    std::string text = std::string(what) + " " + std::to_string(static_cast<int>(phase)) + " after";
    for (std::size_t i = 0; i < kStages; ++i) {
      if (movers_[2 * i + 1].v[0] != 1) text += " " + std::to_string(static_cast<int>(kOrder[i]));
    }
    said.push_back(text);
  }

  soft::Team team_{1};
  std::array<soft::Mover, 2 * kStages + 1> movers_{};
  std::array<SoftPatch, kStages> touching_{};
  SoftPatches patches_{kStep_s, 8};
};

/// What others wait for is sent as soon as it is there, and what needs theirs is solved last. The rest fills the time.
TEST(SoftExchange, MessagesTravelWhileTheRestIsSolved) {
  Sweep sweep;
  sweep.run();
  EXPECT_THAT(sweep.said, ElementsAre("post 1 after 0", "fetch 1 after 1 0 2", "post 2 after 1 3 0 2",
                                      "fetch 2 after 1 3 0 2", "post 3 after 1 3 0 2", "fetch 3 after 1 3 0 2"));
}

}  // namespace
}  // namespace aurasim::physics::testing
