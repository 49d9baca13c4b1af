// RefusalLimit reports some of many refusals, and each participant that is refused.
#include "dds/refusal_limit.h"

#include <gtest/gtest.h>

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

constexpr RefusalLimit::Time kStart{1h};

TEST(RefusalLimit, OneThatIsRefusedOftenDoesNotKeepAnotherFromBeingNamed) {
  RefusalLimit limit;
  std::size_t said = 0;
  for (int i = 0; i < 1000; ++i) said += limit.worth_saying("a", "refused a " + std::to_string(i), kStart).size();
  EXPECT_EQ(said, RefusalLimit::kMostOfOne);
  EXPECT_EQ(limit.worth_saying("b", "refused b", kStart),
            (Words{std::to_string(1000 - RefusalLimit::kMostOfOne) + " more refusals were not listed", "refused b"}));
}

TEST(RefusalLimit, ManyParticipantsDoNotFillTheLog) {
  RefusalLimit limit;
  const auto said_by_1000 = [&](const std::string& what, RefusalLimit::Time now) {
    std::size_t said = 0;
    for (int i = 0; i < 1000; ++i) said += limit.worth_saying(std::to_string(i), what + std::to_string(i), now).size();
    return said;
  };
  EXPECT_EQ(said_by_1000("first", kStart), RefusalLimit::kMostOfAll);
  EXPECT_EQ(said_by_1000("second", kStart + RefusalLimit::kWindow), 0U);
  EXPECT_EQ(said_by_1000("third", kStart + RefusalLimit::kWindow + 1s), RefusalLimit::kMostOfAll + 1)
      << "and the count";
}

TEST(RefusalLimit, ATextIsSaidOnceAMinute) {
  RefusalLimit limit;
  EXPECT_EQ(limit.worth_saying("a", "refused", kStart), Words{"refused"});
  EXPECT_EQ(limit.worth_saying("a", "refused", kStart + 59s), Words{});
  EXPECT_EQ(limit.worth_saying("a", "refused", kStart + 60s), Words{"refused"}) << "a repetition is not left out";
}

}  // namespace
}  // namespace aurasim::dds
