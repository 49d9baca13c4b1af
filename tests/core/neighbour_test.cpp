#include "core/neighbour.h"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/letters.h"
#include "core/random.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ANeighbour : public ::testing::Test {
 protected:
  /// Publishes batches 0 to `last`, all empty.
  void say_nothing_until(Step last) {
    for (Step s = neighbour.received() + 1; s <= last; ++s) ASSERT_TRUE(neighbour.accept(batch(1, s)));
  }
  bool publish(Step stamp, std::vector<AuraRecord> updates, std::vector<BodyId> deletes = {}, bool full = false) {
    AuraBatch b = batch(1, stamp);
    b.updates = std::move(updates);
    b.deletes = std::move(deletes);
    b.full = full;
    return neighbour.accept(std::move(b));
  }
  void mark(Step stamp, std::vector<HandOffMark> marks) {
    AuraBatch b = batch(1, stamp);
    b.hand_offs = std::move(marks);
    neighbour.accept(std::move(b));
  }
  std::vector<std::uint64_t> known() const {
    std::vector<std::uint64_t> ids;
    for (const AuraRecord& a : neighbour.auras()) ids.push_back(value_of(a.id));
    return ids;
  }

  Neighbour neighbour{region(1), region(0)};
};

TEST_F(ANeighbour, HasSaidNothingAtFirst) {
  EXPECT_EQ(neighbour.received(), -1);
  EXPECT_EQ(neighbour.applied(), -1);
  EXPECT_TRUE(neighbour.alive());
}

TEST_F(ANeighbour, IsUnderstoodUpToTheFirstBatchThatIsMissing) {
  publish(0, {});
  publish(2, {});
  publish(3, {});
  EXPECT_EQ(neighbour.received(), 0);
  publish(1, {});
  EXPECT_EQ(neighbour.received(), 3);
}

TEST_F(ANeighbour, CopiesOfABatchAreRefused) {
  EXPECT_TRUE(publish(0, {aura(1)}));
  EXPECT_FALSE(publish(0, {aura(2)}));
  EXPECT_TRUE(publish(2, {}));
  EXPECT_FALSE(publish(2, {}));
  neighbour.apply_until(0);
  EXPECT_FALSE(publish(0, {aura(2)}));
  EXPECT_THAT(known(), ElementsAre(1));
}

TEST_F(ANeighbour, ABatchTakesEffectInItsTurnAndNotBefore) {
  publish(0, {aura(1)});
  publish(1, {aura(2)});
  EXPECT_THAT(known(), IsEmpty());
  neighbour.apply_until(0);
  EXPECT_EQ(neighbour.applied(), 0);
  EXPECT_THAT(known(), ElementsAre(1));
  neighbour.apply_until(1);
  EXPECT_THAT(known(), ElementsAre(1, 2));
}

TEST_F(ANeighbour, ABatchAfterAGapDoesNotTakeEffect) {
  publish(0, {aura(1)});
  publish(2, {aura(2)});
  neighbour.apply_until(5);
  EXPECT_EQ(neighbour.applied(), 0);
  EXPECT_THAT(known(), ElementsAre(1));
}

TEST_F(ANeighbour, UpdatesReplaceAndDeletesRemove) {
  publish(0, {aura(5), aura(1), aura(3)});
  publish(1, {aura(3, 7)}, {body(5)});
  neighbour.apply_until(1);
  EXPECT_THAT(known(), ElementsAre(1, 3));
  EXPECT_EQ(neighbour.auras()[1].epoch, 7u);
}

TEST_F(ANeighbour, ADeleteOfWhatIsNotKnownDoesNothing) {
  publish(0, {aura(1)}, {body(0), body(2)});
  neighbour.apply_until(0);
  EXPECT_THAT(known(), ElementsAre(1));
}

TEST_F(ANeighbour, AFullBatchForgetsWhatWasBefore) {
  publish(0, {aura(1), aura(2)});
  publish(1, {aura(2), aura(3)}, {}, true);
  neighbour.apply_until(1);
  EXPECT_THAT(known(), ElementsAre(2, 3));
}

AuraRecord aura_for(std::uint64_t id, Audience audience) {
  AuraRecord record = aura(id);
  record.audience = audience;
  return record;
}

TEST_F(ANeighbour, AurasForOthersAreNotKept) {
  publish(0, {aura_for(1, audience_of(region(0))), aura_for(2, audience_of(region(2))), aura_for(3, kAllListeners)});
  neighbour.apply_until(0);
  EXPECT_THAT(known(), ElementsAre(1, 3));
  publish(1, {aura_for(4, audience_of(region(2))), aura_for(5, kAllListeners)}, {}, true);
  neighbour.apply_until(1);
  EXPECT_THAT(known(), ElementsAre(5)) << "a full batch, too, is read for what is ours";
}

TEST_F(ANeighbour, AnAuraThatIsNoLongerForUsIsForgotten) {
  publish(0, {aura(1), aura(2), aura(3)});
  publish(1, {aura_for(2, audience_of(region(2)))});
  neighbour.apply_until(1);
  EXPECT_THAT(known(), ElementsAre(1, 3));
  publish(2, {aura_for(2, audience_of(region(0)) | audience_of(region(2)))});
  neighbour.apply_until(2);
  EXPECT_THAT(known(), ElementsAre(1, 2, 3));
}

TEST_F(ANeighbour, TellsItsTopSpeedRadiusAndViolationsOfTheBatchInEffect) {
  AuraBatch b = batch(1, 0);
  b.top_speed_m_s = 12;
  b.top_radius_m = 3;
  b.violations = 4;
  neighbour.accept(b);
  EXPECT_EQ(neighbour.top_speed_m_s(), 0);
  neighbour.apply_until(0);
  EXPECT_EQ(neighbour.top_speed_m_s(), 12);
  EXPECT_EQ(neighbour.top_radius_m(), 3);
  EXPECT_EQ(neighbour.violations(), 4u);
}

TEST_F(ANeighbour, MarksSayWhichHandOffsToUsCameUpToAStamp) {
  say_nothing_until(2);
  mark(3, {{region(0), 1}, {region(2), 9}});
  say_nothing_until(5);
  mark(6, {{region(0), 3}});
  EXPECT_EQ(neighbour.hand_offs_until(2), 0u);
  EXPECT_EQ(neighbour.hand_offs_until(3), 1u);
  EXPECT_EQ(neighbour.hand_offs_until(5), 1u);
  EXPECT_EQ(neighbour.hand_offs_until(6), 3u);
}

TEST_F(ANeighbour, AMarkBehindAGapIsNotKnownYet) {
  say_nothing_until(2);
  mark(4, {{region(0), 1}});
  EXPECT_EQ(neighbour.hand_offs_until(9), 0u);
  say_nothing_until(3);
  EXPECT_EQ(neighbour.hand_offs_until(9), 1u);
}

TEST_F(ANeighbour, MarksAreRememberedHoweverLongItHandsNothingOver) {
  mark(0, {{region(0), 1}});
  mark(1, {{region(0), 2}});
  say_nothing_until(1000);
  neighbour.apply_until(1000);
  EXPECT_EQ(neighbour.hand_offs_until(999), 2u);
}

TEST_F(ANeighbour, ADeadOnesAurasAndUnheardBatchesAreForgotten) {
  publish(0, {aura(1)});
  publish(1, {aura(2)});
  neighbour.apply_until(0);
  neighbour.mark_dead();
  neighbour.apply_until(5);
  EXPECT_FALSE(neighbour.alive());
  EXPECT_THAT(known(), IsEmpty());
  EXPECT_EQ(neighbour.applied(), 0);
}

/// What the batches add up to, told by the simplest means.
using Book = std::map<std::uint64_t, Epoch>;

AuraBatch random_batch(Random& random, Step stamp, Book& book) {
  AuraBatch b = batch(1, stamp);
  b.full = random.chance(0.05);
  if (b.full) book.clear();
  std::map<std::uint64_t, Epoch> updates;
  for (std::uint32_t i = random.below(6); i > 0; --i) updates[random.below(20)] = static_cast<Epoch>(stamp);
  std::vector<std::uint64_t> deletes;
  for (const auto& [id, epoch] : book) {
    if (!updates.contains(id) && random.chance(0.2)) deletes.push_back(id);
  }
  for (const auto& [id, epoch] : updates) {
    b.updates.push_back(aura(id, epoch));
    book[id] = epoch;
  }
  for (const std::uint64_t id : deletes) {
    b.deletes.push_back(body(id));
    book.erase(id);
  }
  std::shuffle(b.updates.begin(), b.updates.end(), random.bits());
  std::shuffle(b.deletes.begin(), b.deletes.end(), random.bits());
  return b;
}

TEST(Neighbours, BatchesInAnyOrderWithCopiesAddUpToTheSame) {
  Random random("orders");
  for (int run = 0; run < 100; ++run) {
    std::vector<Book> books;
    std::vector<AuraBatch> batches;
    Book book;
    for (Step s = 0; s < 40; ++s) {
      batches.push_back(random_batch(random, s, book));
      books.push_back(book);
      if (random.chance(0.3)) batches.push_back(batches.back());
    }
    std::shuffle(batches.begin(), batches.end(), random.bits());
    Neighbour neighbour(region(1), region(0));
    for (const AuraBatch& b : batches) {
      neighbour.accept(b);
      if (random.chance(0.5)) neighbour.apply_until(neighbour.received());
      if (neighbour.applied() < 0) continue;
      Book received;
      for (const AuraRecord& a : neighbour.auras()) received[value_of(a.id)] = a.epoch;
      ASSERT_EQ(received, books[static_cast<std::size_t>(neighbour.applied())]);
    }
    EXPECT_EQ(neighbour.received(), 39);
  }
}

}  // namespace
}  // namespace aurasim::core::testing
