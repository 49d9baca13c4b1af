// Messages in parts: cut, and put together again, whatever becomes of the parts on the way. Time is virtual.
#include "messages/parts.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::messages {
namespace {

using namespace std::chrono_literals;
using Octets = std::vector<std::uint8_t>;
using ::testing::ElementsAre;

constexpr std::size_t kPart_B = 1000;

Octets message(std::size_t size, std::uint8_t first) {
  Octets octets(size);
  for (std::size_t i = 0; i < size; ++i) octets[i] = static_cast<std::uint8_t>(first + i * 7);
  return octets;
}

PartAssembly::Stream stream_of(std::uint8_t process, std::uint64_t endpoints = 1) { return {{process}, endpoints}; }

class Parts : public ::testing::Test {
 protected:
  /// Takes a part in. Whole messages go to `wholes_`.
  void take(const Part& part, const PartAssembly::Stream& from = stream_of(1)) {
    auto added = assembly_.add(from, part, now_);
    lost_ += added.lost;
    if (added.whole) wholes_.push_back(std::move(*added.whole));
  }
  void take_all(const Octets& whole, std::uint64_t number, const PartAssembly::Stream& from = stream_of(1)) {
    for (std::uint32_t i = 0; i < parts_of(whole.size(), kPart_B); ++i) take(part_of(whole, number, i, kPart_B), from);
  }

  static PartLimits narrow() {
    PartLimits limits;
    limits.message_B = 50'000;
    limits.of_a_process_B = 60'000;
    limits.all_B = 100'000;
    limits.streams = 100;
    return limits;
  }

  PartAssembly assembly_{narrow()};
  PartAssembly::Time now_ = 1h;
  std::vector<Octets> wholes_;
  std::uint64_t lost_ = 0;
};

TEST_F(Parts, CoverTheMessageWithoutGaps) {
  for (const std::size_t size : {1001U, 1999U, 2000U, 2001U, 49'999U}) {
    const Octets whole = message(size, 3);
    Octets together;
    const std::uint32_t count = parts_of(size, kPart_B);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Part part = part_of(whole, 1, i, kPart_B);
      EXPECT_EQ(part.count, count);
      EXPECT_LE(part.octets.size(), kPart_B);
      together.insert(together.end(), part.octets.begin(), part.octets.end());
    }
    EXPECT_EQ(together, whole);
  }
}

TEST_F(Parts, MakeTheMessageInAnyOrderAndTwice) {
  std::mt19937 random(20);
  for (std::uint64_t number = 1; number <= 50; ++number) {
    const Octets whole = message(20'500, static_cast<std::uint8_t>(number));
    std::vector<Part> parts;
    for (std::uint32_t i = 0; i < 21; ++i) parts.push_back(part_of(whole, number, i, kPart_B));
    parts.insert(parts.end(), parts.begin(), parts.begin() + 5);
    std::ranges::shuffle(parts, random);
    wholes_.clear();
    for (const Part& part : parts) take(part);
    EXPECT_THAT(wholes_, ElementsAre(whole));
  }
  EXPECT_EQ(assembly_.bytes(), 0U);
  EXPECT_EQ(lost_, 0U);
}

TEST_F(Parts, OfSeveralMessagesMayBeMixed) {
  const Octets first = message(3000, 1), second = message(4000, 2);
  for (std::uint32_t i = 0; i < 4; ++i) {
    take(part_of(second, 2, i, kPart_B));
    if (i < 3) take(part_of(first, 1, i, kPart_B));
  }
  EXPECT_THAT(wholes_, ElementsAre(first, second));
}

TEST_F(Parts, ThatAreMissingLoseTheirMessageAlone) {
  for (std::uint64_t number = 1; number <= 100; ++number) {
    const Octets whole = message(5000, static_cast<std::uint8_t>(number));
    for (std::uint32_t i = 0; i < 5; ++i) {
      if (number % 10 != 0 || i != 3) take(part_of(whole, number, i, kPart_B));
    }
  }
  EXPECT_EQ(wholes_.size(), 90U);
  EXPECT_EQ(lost_, 9U) << "the last one may still come";
  EXPECT_LE(assembly_.bytes(), 4000U);
}

TEST_F(Parts, OfAMessageThatIsLongPastAreDropped) {
  for (std::uint64_t number = 1; number <= 20; ++number) take_all(message(2000, 1), number);
  wholes_.clear();
  for (std::uint64_t number = 1; number <= 20; ++number) take_all(message(2000, 1), number);
  EXPECT_TRUE(wholes_.empty()) << "they were handed on before";
  EXPECT_EQ(assembly_.bytes(), 0U);
}

/// Whoever joins in the middle of a message lacks what came before. Nothing is wrong with that.
TEST_F(Parts, BeforeTheFirstReceiptAreNotLost) {
  const Octets half = message(5000, 1);
  for (std::uint32_t i = 2; i < 5; ++i) take(part_of(half, 7, i, kPart_B));
  for (std::uint64_t number = 8; number < 30; ++number) take_all(message(2000, 1), number);
  EXPECT_EQ(wholes_.size(), 22U);
  EXPECT_EQ(lost_, 0U);
}

/// Its numbers begin anew, and its process and endpoints are others.
TEST_F(Parts, OfASenderThatHasRestartedAreAnotherStream) {
  const Octets whole = message(5000, 1);
  for (std::uint64_t number = 1; number <= 30; ++number) take_all(whole, number, stream_of(1));
  for (std::uint32_t i = 0; i < 4; ++i) take(part_of(whole, 31, i, kPart_B), stream_of(1));
  wholes_.clear();
  take_all(message(5000, 2), 1, stream_of(2));
  take_all(message(5000, 3), 1, stream_of(1, 2));
  EXPECT_THAT(wholes_, ElementsAre(message(5000, 2), message(5000, 3)));
}

TEST_F(Parts, ThatCannotBeAreDropped) {
  const Octets octets(10, 1);
  const auto drops = [&](const Part& part) {
    take(part);
    return wholes_.empty() && assembly_.bytes() == 0;
  };
  EXPECT_TRUE(drops({0, 0, 2, octets})) << "no number";
  EXPECT_TRUE(drops({1, 0, 0, octets})) << "of no parts";
  EXPECT_TRUE(drops({1, 0, 1, octets})) << "it would be whole";
  EXPECT_TRUE(drops({1, 2, 2, octets})) << "beyond the last";
  EXPECT_TRUE(drops({1, ~0U, ~0U, octets}));
  EXPECT_TRUE(drops({1, 0, ~0U, octets})) << "more than a message has";
  EXPECT_TRUE(drops({1, 0, 2, {}}));
}

TEST_F(Parts, ThatContradictEachOtherLoseTheirMessage) {
  const Octets whole = message(5000, 1);
  take(part_of(whole, 1, 0, kPart_B));
  take({1, 1, 77, std::span(whole).first(100)});
  EXPECT_EQ(lost_, 1U);
  EXPECT_EQ(assembly_.bytes(), 0U);
  take_all(whole, 1);
  EXPECT_TRUE(wholes_.empty());
  take_all(whole, 2);
  EXPECT_THAT(wholes_, ElementsAre(whole));
}

TEST_F(Parts, AreNotMoreThanTheLargestMessage) {
  const Octets whole = message(60'000, 1);
  take_all(whole, 1);
  EXPECT_TRUE(wholes_.empty());
  EXPECT_EQ(lost_, 1U);
  EXPECT_EQ(assembly_.bytes(), 0U);
}

/// Somebody begins messages on many streams, and ends none.
TEST_F(Parts, OfOneProcessLeaveRoomForOthers) {
  const Octets whole = message(40'000, 1);
  for (std::uint64_t endpoint = 1; endpoint < 90; ++endpoint) {
    for (std::uint32_t i = 0; i < 39; ++i) take(part_of(whole, 1, i, kPart_B), stream_of(66, endpoint));
    EXPECT_LE(assembly_.bytes(), 60'000U);
  }
  take_all(whole, 1, stream_of(1));
  EXPECT_THAT(wholes_, ElementsAre(whole));
}

TEST_F(Parts, ThatNobodyContinuesMakeRoom) {
  const Octets whole = message(40'000, 1);
  for (std::uint8_t process = 1; process <= 20; ++process) {
    for (std::uint32_t i = 0; i < 39; ++i) take(part_of(whole, 1, i, kPart_B), stream_of(process));
  }
  EXPECT_LE(assembly_.bytes(), 100'000U);
  take_all(whole, 1, stream_of(99));
  EXPECT_TRUE(wholes_.empty()) << "there is no room yet";
  now_ += 11s;
  take_all(whole, 2, stream_of(99));
  EXPECT_THAT(wholes_, ElementsAre(whole));
  EXPECT_EQ(assembly_.bytes(), 0U);
}

TEST_F(Parts, OfMoreStreamsThanThereCanBeAreForgottenWhenTheyAreQuiet) {
  const Octets whole = message(2000, 1);
  for (std::uint64_t endpoint = 1; endpoint <= 200; ++endpoint) take_all(whole, 1, stream_of(1, endpoint));
  EXPECT_EQ(wholes_.size(), 100U);
  now_ += 11s;
  for (std::uint64_t endpoint = 201; endpoint <= 300; ++endpoint) take_all(whole, 1, stream_of(1, endpoint));
  EXPECT_EQ(wholes_.size(), 200U);
}

/// A quarter of all parts is lost, others come late or twice. What is handed on is right, and never twice.
TEST_F(Parts, OnABadNetworkNeverMakeAnythingWrong) {
  std::mt19937 random(39);
  const auto chance = [&](double p) { return std::uniform_real_distribution<>()(random) < p; };
  std::vector<Octets> sent;
  std::vector<Part> late;
  for (std::uint64_t number = 1; number <= 1000; ++number) {
    sent.push_back(message(1001 + random() % 4000, static_cast<std::uint8_t>(number)));
  }
  for (std::uint64_t number = 1; number <= sent.size(); ++number) {
    const Octets& whole = sent[number - 1];
    for (std::uint32_t i = 0; i < parts_of(whole.size(), kPart_B); ++i) {
      const Part part = part_of(whole, number, i, kPart_B);
      if (chance(0.25)) continue;
      if (chance(0.1)) late.push_back(part);
      if (!chance(0.1)) take(part);
      if (late.size() > 5) {
        take(late.front());
        late.erase(late.begin());
      }
    }
  }
  EXPECT_GT(wholes_.size(), 200U) << "or this test shows nothing";
  EXPECT_GT(lost_, 200U);
  EXPECT_LE(wholes_.size() + lost_, sent.size());
  auto from = sent.begin();
  std::size_t behind = 0;
  for (const Octets& whole : wholes_) {
    const auto found = std::ranges::find(sent, whole);
    ASSERT_NE(found, sent.end());
    behind += found < from ? 1 : 0;
    from = found;
    found->clear();
  }
  EXPECT_LE(assembly_.bytes(), PartAssembly::kWindow * 5000);
  EXPECT_LT(behind, wholes_.size());
}

}  // namespace
}  // namespace aurasim::messages
