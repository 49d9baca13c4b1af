// When is a saved world whole, and when is it given up? In virtual time.
#include "cut/save_ledger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::cut {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr core::RegionId kSelf{0}, kOne{1}, kTwo{2};

class Ledger : public testing::Test {
 protected:
  std::vector<SaveLedger::Outcome> outcomes() { return ledger_.take_outcomes(now_); }

  SaveLedger ledger_{kSelf, 3};
  SaveLedger::Clock::time_point now_{};
};

TEST_F(Ledger, ASaveIsWholeOnceAllRegionsHaveTheirParts) {
  ledger_.begin(7);
  ledger_.receive(kOne, {5, 7}, {});
  ledger_.receive(kTwo, {7}, {});
  EXPECT_THAT(outcomes(), IsEmpty());
  ledger_.note_own(7, true);
  const auto all = outcomes();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].save, 7U);
  EXPECT_EQ(all[0].fate, SaveFate::kWhole);
  EXPECT_THAT(outcomes(), IsEmpty()) << "once";
  EXPECT_THAT(ledger_.saved(), ElementsAre(7));
}

/// Its part is on its disk, whatever the process that comes in its place says.
TEST_F(Ledger, WhoHasWrittenAndDiedHasWritten) {
  ledger_.begin(7);
  ledger_.note_own(7, true);
  ledger_.receive(kOne, {7}, {});
  ledger_.receive(kOne, {}, {});
  ledger_.receive(kTwo, {7}, {});
  EXPECT_EQ(outcomes().size(), 1U);
}

TEST_F(Ledger, WhoDiesBeforeItHasWrittenLeavesTheSaveOpen) {
  ledger_.begin(7);
  ledger_.note_own(7, true);
  ledger_.receive(kOne, {7}, {});
  now_ += 1h;
  EXPECT_THAT(outcomes(), IsEmpty());
  ledger_.forget(7);
  ledger_.receive(kTwo, {7}, {});
  EXPECT_THAT(outcomes(), IsEmpty());
}

TEST_F(Ledger, ASaveFailsWithTheNamesOfAllThatCouldNotWrite) {
  ledger_.begin(7);
  ledger_.receive(kTwo, {}, {7});
  now_ += 1h;
  EXPECT_THAT(outcomes(), IsEmpty()) << "its own part is being written";
  ledger_.note_own(7, false);
  ledger_.receive(kOne, {7}, {});
  const auto all = outcomes();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].fate, SaveFate::kFailed);
  EXPECT_THAT(all[0].without, ElementsAre(kSelf, kTwo));
  EXPECT_THAT(ledger_.not_saved(), ElementsAre(7));
}

TEST_F(Ledger, AFailedSaveDoesNotWaitForWhoDoesNotSpeak) {
  ledger_.begin(7);
  ledger_.note_own(7, true);
  ledger_.receive(kOne, {}, {7});
  EXPECT_THAT(outcomes(), IsEmpty());
  now_ += 3s;
  const auto all = outcomes();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_THAT(all[0].without, ElementsAre(kOne));
}

TEST_F(Ledger, AStatusNamesTheNewestOnly) {
  for (std::uint64_t save = 1; save <= 100; ++save) {
    ledger_.begin(save);
    ledger_.note_own(save, true);
  }
  EXPECT_LE(ledger_.saved().size(), 32U);
  EXPECT_EQ(ledger_.saved().back(), 100U);
}

}  // namespace
}  // namespace aurasim::cut
