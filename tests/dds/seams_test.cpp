// Parcels between coupled regions that really talk over DDS on loopback.
#include <atomic>
#include <barrier>
#include <future>

#include <gtest/gtest.h>

#include "dds/dds_seams.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using namespace std::chrono_literals;

/// One of three regions in a row.
struct Coupled {
  Coupled(std::uint32_t region, std::initializer_list<std::uint32_t> near,
          const Settings& of_dds = testing::settings_for(own_domain()))
      : participant(of_dds), seams(participant, settings(region, near)) {}

  /// The region takes the others for lost when a test has gone on for too long.
  static SeamSettings settings(std::uint32_t region, std::initializer_list<std::uint32_t> near) {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    return {.region = RegionId{region},
            .region_count = 3,
            .near = testing::regions(near),
            .map_version = testing::kMapVersion,
            .is_lost = [deadline](RegionId) { return std::chrono::steady_clock::now() > deadline; }};
  }
  void post(std::uint32_t to, std::uint8_t content) {
    const std::vector<std::byte> parcel(100, std::byte{content});
    seams.post(RegionId{to}, parcel);
  }
  std::vector<std::byte> fetch(std::uint32_t from) {
    const std::span<const std::byte> parcel = seams.fetch(RegionId{from});
    return {parcel.begin(), parcel.end()};
  }

  Participant participant;
  DdsSeams seams;
};

std::vector<std::byte> parcel_of(std::uint8_t content) { return std::vector<std::byte>(100, std::byte{content}); }

bool are_matched(const Coupled& one, std::uint32_t other) { return one.seams.unmatched(RegionId{other}).empty(); }

TEST(Seams, HaveWritersToNearRegionsFromTheBeginning) {
  Coupled left(0, {1}), middle(1, {0, 2});
  EXPECT_EQ(left.seams.endpoints_of(RegionId{1}), 2U);
  EXPECT_EQ(left.seams.endpoints_of(RegionId{2}), 0U);
  ASSERT_TRUE(testing::holds_in_time([&] { return are_matched(left, 1) && are_matched(middle, 0); }));
  EXPECT_TRUE(are_matched(left, 2)) << "nobody waits for it, though it is not there";
  left.seams.begin(0, 1), middle.seams.begin(0, 1);
  left.post(1, 7), middle.post(0, 8);
  EXPECT_EQ(left.fetch(1), parcel_of(8));
  EXPECT_EQ(middle.fetch(0), parcel_of(7));
}

/// A parcel to a region that is not there yet is lost, and sent again when that region asks. The sender computes
/// meanwhile: a thread of DDS answers.
TEST(Seams, AnswerWhoAsksWhileTheyCompute) {
  Coupled left(0, {});
  left.seams.begin(0, 1);
  left.post(2, 1);
  left.post(2, 101);
  Coupled right(2, {});
  right.seams.begin(0, 1);
  EXPECT_EQ(right.fetch(0), parcel_of(1));
  EXPECT_EQ(right.fetch(0), parcel_of(101));
  EXPECT_GT(right.seams.counters().questions, 0U);
  EXPECT_EQ(right.seams.times().counters.questions, right.seams.counters().questions);
  EXPECT_EQ(right.seams.times().counters.questions, 0U) << "since it was told";
  EXPECT_GT(left.seams.counters().repeated, 0U);
  EXPECT_EQ(left.seams.endpoints_of(RegionId{2}), 1U);
  EXPECT_TRUE(are_matched(left, 2));
}

/// A region that begins a step may only know that most have ended the one before (core/seam_tree.h).
TEST(Seams, AnswerWhoIsAStepBehind) {
  Coupled left(0, {});
  left.seams.begin(0, 1);
  left.post(2, 1);
  left.seams.begin(0, 2);
  left.post(2, 2);
  Coupled right(2, {});
  right.seams.begin(0, 1);
  EXPECT_EQ(right.fetch(0), parcel_of(1));
  right.seams.begin(0, 2);
  EXPECT_EQ(right.fetch(0), parcel_of(2));
}

TEST(Seams, CountNoExchangeBeforeTheyBegin) {
  Coupled left(0, {1}), right(1, {0});
  ASSERT_TRUE(testing::holds_in_time([&] { return are_matched(left, 1) && are_matched(right, 0); }));
  left.seams.begin(0, 1), right.seams.begin(0, 1);
  right.post(0, 1), right.post(0, 2);
  EXPECT_EQ(left.fetch(1), parcel_of(1));
  EXPECT_EQ(left.seams.times().seconds.size(), 1U);
  left.seams.begin_exchanges();
  EXPECT_TRUE(left.seams.times().seconds.empty());
  EXPECT_EQ(left.seams.times().waited_s, 0);
  EXPECT_EQ(left.fetch(1), parcel_of(2));
  EXPECT_EQ(left.seams.times().seconds.size(), 1U);
}

/// Fills parcels of a step so that both ends know what has to come. They may need many datagrams.
std::vector<std::byte> large_parcel(std::uint32_t from, core::Step step, int number) {
  const std::size_t size_B = number == 0 ? 300'000 : static_cast<std::size_t>(step % 5) * 40'000;
  std::vector<std::byte> parcel(size_B);
  for (std::size_t i = 0; i < size_B; ++i)
    parcel[i] = static_cast<std::byte>(i * 7 + static_cast<std::size_t>(step) * 13 + from);
  return parcel;
}

TEST(Seams, LoseNothingOnANetworkThatLosesDatagrams) {
  const auto settings = [](std::uint64_t stream) {
    Settings impaired = testing::settings_for(own_domain());
    impaired.impairment = {.jitter_s = 0.0005, .loss = 0.2, .reorder = true, .seed = 5};
    impaired.impairment_stream = stream;
    return impaired;
  };
  Coupled left(0, {1}, settings(1)), right(1, {0}, settings(2));
  ASSERT_TRUE(testing::holds_in_time([&] { return are_matched(left, 1) && are_matched(right, 0); }));
  constexpr core::Step kSteps = 40;
  constexpr int kParcels = 3;
  std::barrier batches(2);  // a step begins when all have ended the one before
  const auto run = [&](Coupled& self, std::uint32_t own, std::uint32_t other) {
    for (core::Step step = 1; step <= kSteps; ++step) {
      self.seams.begin(0, step);
      for (int i = 0; i < kParcels; ++i) {
        self.seams.post(RegionId{other}, large_parcel(own, step, i));
        EXPECT_EQ(self.fetch(other), large_parcel(other, step, i)) << step << " " << i;
      }
      batches.arrive_and_wait();
    }
  };
  const auto run_to_the_end = [&](Coupled& self, std::uint32_t own, std::uint32_t other) {
    try {
      run(self, own, other);
    } catch (...) {
      batches.arrive_and_drop();  // or the other one would wait for ever
      throw;
    }
  };
  auto other = std::async(std::launch::async, [&] { run_to_the_end(right, 1, 0); });
  run_to_the_end(left, 0, 1);
  other.get();
  EXPECT_GT(left.seams.counters().repeated + right.seams.counters().repeated, 50U) << "or this test shows nothing";
}

/// Others may have given the step up where this node has lost nobody: it is not heard any more, and hears all.
TEST(Seams, AreBrokenWhenOthersStand) {
  SeamSettings settings = Coupled::settings(0, {1});
  std::atomic<bool> others_stand = false;
  settings.why_stand = [&]() -> std::optional<std::string> {
    return others_stand ? std::optional("region 1 stands") : std::nullopt;
  };
  Coupled right(1, {0});
  Participant participant(testing::settings_for(own_domain()));
  DdsSeams left(participant, settings);
  ASSERT_TRUE(testing::holds_in_time([&] { return left.unmatched(RegionId{1}).empty() && are_matched(right, 0); }));
  left.begin(0, 1), right.seams.begin(0, 1);
  right.post(0, 7);
  EXPECT_EQ(left.fetch(RegionId{1}).size(), 100U);
  auto waiting = std::async(std::launch::async, [&]() -> std::string {
    try {
      left.fetch(RegionId{1});
    } catch (const core::SeamsBroken& broken) {
      return broken.what();
    }
    return "a parcel that nobody has sent";
  });
  EXPECT_EQ(waiting.wait_for(300ms), std::future_status::timeout) << "while the others compute";
  others_stand = true;
  EXPECT_EQ(waiting.get(), "region 1 stands");
}

}  // namespace
}  // namespace aurasim::dds
