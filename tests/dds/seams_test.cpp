// Parcels between coupled regions that really talk over DDS on loopback.
#include <atomic>
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
  Coupled(std::uint32_t region, std::initializer_list<std::uint32_t> near)
      : participant(testing::settings_for(own_domain())), seams(participant, settings(region, near)) {}

  /// The region takes the others for lost when a test has gone on for too long.
  static SeamSettings settings(std::uint32_t region, std::initializer_list<std::uint32_t> near) {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    return {.region = RegionId{region},
            .region_count = 3,
            .near = testing::regions(near),
            .map_version = testing::kMapVersion,
            .is_lost = [deadline](RegionId) { return std::chrono::steady_clock::now() > deadline; },
            .is_node = [](RegionId, const ProcessPrefix&) { return true; }};
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

/// The first parcels go to a region whose reader is not known yet, and that learns of the writer later still.
TEST(Seams, LoseNoParcelToARegionThatIsNotNear) {
  Coupled left(0, {});
  std::atomic<bool> has_posted = false;
  auto posting = std::async(std::launch::async, [&] {
    for (std::uint8_t step = 1; step <= 20; ++step) {
      left.seams.begin(0, step);
      left.post(2, step);
      has_posted = true;
      left.post(2, static_cast<std::uint8_t>(100 + step));
    }
  });
  std::this_thread::sleep_for(300ms);
  EXPECT_FALSE(has_posted) << "to nobody";
  Coupled right(2, {});
  for (std::uint8_t step = 1; step <= 20; ++step) {
    right.seams.begin(0, step);
    ASSERT_EQ(right.fetch(0), parcel_of(step));
    ASSERT_EQ(right.fetch(0), parcel_of(static_cast<std::uint8_t>(100 + step)));
  }
  posting.get();
  EXPECT_EQ(left.seams.endpoints_of(RegionId{2}), 1U);
  EXPECT_TRUE(are_matched(left, 2));
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
