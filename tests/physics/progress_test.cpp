// A step marks its progress inside: whoever watches it tells a long one from one that hangs.
#include "core/progress.h"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <thread>

#include <gtest/gtest.h>
#include <pthread.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

/// Each box overlaps all others.
std::vector<core::BodyRecord> heap(int edge) {
  std::vector<core::BodyRecord> boxes;
  for (int i = 0; i < edge * edge * edge; ++i) {
    const core::Vec3 place(i % edge, i / edge % edge, i / edge / edge);
    boxes.push_back(body(static_cast<std::uint64_t>(i), 0, core::Vec3(0, 0, 5) + 0.05 * place));
  }
  return boxes;
}

Settings settings_with(Solver solver, int iterations) {
  Settings settings;
  settings.solver = solver;
  settings.solver_iterations = iterations;
  return settings;
}

/// In the first step of a heap.
std::uint64_t marks_of_a_heap(Solver solver, int edge) {
  const core::Scene scene = scene_of(core::Box{});
  RegionWorld world(scene, settings_with(solver, 10));
  world.add(heap(edge));
  const std::uint64_t before = core::Progress::marks();
  world.step();
  return core::Progress::marks() - before;
}

/// Looks at the marks of the thread that has made it, by that thread's own time: others on this machine do not count.
class Watcher {
 public:
  Watcher() {
    ::pthread_getcpuclockid(::pthread_self(), &clock_);
    thread_ = std::thread([this] { look(); });
  }
  ~Watcher() { thread_.join(); }

  void end() { ended_ = true; }
  double longest_s() const { return longest_s_; }
  double all_s() const { return all_s_; }

 private:
  double now_s() const {
    ::timespec time{};
    ::clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  void look() {
    const double begin_s = now_s();
    std::uint64_t marks = core::Progress::marks();
    for (double since_s = now_s(); !ended_;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      // The clock is read before and after the marks, so that a watcher that waits for a core never reports too much.
      const double time_s = now_s();
      const std::uint64_t seen = core::Progress::marks();
      if (seen == marks) {
        longest_s_ = std::max(longest_s_.load(), time_s - since_s);
      } else {
        marks = seen;
        since_s = now_s();
      }
      all_s_ = time_s - begin_s;
    }
  }

  ::clockid_t clock_{};
  std::atomic<bool> ended_ = false;
  std::atomic<double> longest_s_ = 0, all_s_ = 0;
  std::thread thread_;
};

class Heap : public ::testing::TestWithParam<Solver> {};

/// 27 boxes are 351 pairs, 216 are 23,220.
TEST_P(Heap, TheMoreWorkInAStepTheMoreMarks) {
  const std::uint64_t few = marks_of_a_heap(GetParam(), 3), many = marks_of_a_heap(GetParam(), 6);
  EXPECT_GT(few, 0U);
  EXPECT_GT(many, 23'220U / 16);
  EXPECT_GT(many, 2 * few) << "a sweep marks a few times, however little it has to do";
}

TEST_P(Heap, NoLargePartOfAStepIsWithoutAMark) {
  const core::Scene scene = scene_of(core::Box{});
  RegionWorld world(scene, settings_with(GetParam(), 200));
  world.add(heap(6));
  Watcher watcher;
  // The watcher looks once a millisecond: a step that is short is repeated until that is little of the whole.
  for (int i = 0; i < 2 || (watcher.all_s() < 0.5 && i < 1000); ++i) world.step();
  watcher.end();
  EXPECT_LT(watcher.longest_s(), 0.2 * watcher.all_s());
}

INSTANTIATE_TEST_SUITE_P(Solvers, Heap, ::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep));

}  // namespace
}  // namespace aurasim::physics::testing
