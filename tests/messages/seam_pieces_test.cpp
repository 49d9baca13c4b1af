// Parcels between coupled regions over a network that loses, repeats and swaps their pieces.
#include "messages/seam_pieces.h"

#include <algorithm>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/seam_codec.h"

namespace aurasim::messages {
namespace {

constexpr std::size_t kPiece_B = 10;

SeamHeader header_of(core::Step step, std::uint32_t number) {
  return {core::RegionId{0}, core::RegionId{1}, 3, step, number};
}

std::vector<std::byte> random_parcel(std::mt19937& random) {
  std::vector<std::byte> parcel(std::uniform_int_distribution<std::size_t>(0, 5 * kPiece_B)(random));
  for (std::byte& octet : parcel) octet = static_cast<std::byte>(random());
  return parcel;
}

/// A piece under way.
struct Sent {
  SeamHeader header;
  bool goes_on = false;
  std::vector<std::byte> octets;
};

Sent sent(core::Step step, const PostedPieces::Piece& piece) {
  return {header_of(step, piece.number), piece.goes_on, piece.octets};
}

SeamPiece received(const Sent& piece) { return {piece.header, piece.goes_on, piece.octets, {}}; }

/// Cuts a parcel, and gives the pieces.
std::vector<Sent> post(PostedPieces& posted, core::Step step, std::span<const std::byte> parcel) {
  std::vector<Sent> pieces;
  cut(parcel, kPiece_B, [&](std::span<const std::byte> octets, bool goes_on) {
    pieces.push_back(sent(step, posted.add(octets, goes_on)));
  });
  return pieces;
}

TEST(SeamPieces, BecomeTheParcelsThatWerePostedWhateverTheNetworkDoes) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const double loss = std::uniform_real_distribution<>(0, 0.7)(random);
    std::bernoulli_distribution is_lost(loss), is_repeated(0.2);
    PostedPieces posted;
    ArrivedPieces arrived;
    std::size_t lost = 0;
    for (core::Step step = 1; step <= 5; ++step) {
      posted.begin();
      if (step % 2 == 0) arrived.begin(3, step);  // else what comes is of a step that the receiver has not begun
      std::vector<std::vector<std::byte>> parcels(std::uniform_int_distribution<std::size_t>(1, 6)(random));
      std::deque<Sent> under_way;
      const auto send = [&](const Sent& piece) {
        if (is_lost(random)) return void(++lost);
        for (int i = 0; i <= is_repeated(random); ++i) under_way.push_back(piece);
      };
      for (auto& parcel : parcels) {
        parcel = random_parcel(random);
        std::ranges::for_each(post(posted, step, parcel), send);
      }
      std::size_t fetched = 0;
      for (int rounds = 0; fetched < parcels.size(); ++rounds) {
        ASSERT_LT(rounds, 1000) << "seed " << seed;
        std::ranges::shuffle(under_way, random);
        for (const Sent& piece : under_way) arrived.add(received(piece));
        under_way.clear();
        if (rounds == 0 && step % 2 != 0) arrived.begin(3, step);
        for (std::vector<std::byte> parcel; arrived.take(parcel);) {
          ASSERT_LT(fetched, parcels.size());
          EXPECT_EQ(parcel, parcels[fetched++]) << "seed " << seed;
        }
        const auto lacking = arrived.lacking();
        ASSERT_FALSE(lacking.empty()) << "at least what comes next";
        posted.answer(lacking, SIZE_MAX, [&](const PostedPieces::Piece& piece) { send(sent(step, piece)); });
      }
      EXPECT_FALSE(arrived.ahead());
    }
    if (loss > 0.3) {
      EXPECT_GT(lost, 0U);
    }
  }
}

TEST(SeamPieces, OfEarlierStepsAndKnownOnesAreDropped) {
  ArrivedPieces arrived;
  arrived.begin(3, 7);
  const std::vector<std::byte> octets(4);
  const auto add = [&](core::Step step, std::uint32_t number) {
    return arrived.add({header_of(step, number), false, octets, {}});
  };
  EXPECT_FALSE(add(6, 1));
  EXPECT_TRUE(add(7, 2));
  EXPECT_FALSE(add(7, 2));
  std::vector<std::byte> parcel;
  EXPECT_FALSE(arrived.take(parcel)) << "the first is lacking";
  EXPECT_TRUE(std::ranges::equal(arrived.lacking(), std::vector<std::uint32_t>{1, 3}));
  EXPECT_FALSE(arrived.ahead());
  EXPECT_TRUE(add(8, 1));
  ASSERT_TRUE(arrived.ahead());
  EXPECT_EQ(arrived.ahead()->step, 8);
  EXPECT_FALSE(add(7, ArrivedPieces::kMostPieces + 1)) << "nobody sends so many";
}

TEST(SeamPieces, AreAskedForInQuestionsOfBoundedSize) {
  ArrivedPieces arrived;
  arrived.begin(3, 7);
  const std::vector<std::byte> octets(4);
  for (std::uint32_t number = 2; number < 1000; number += 2) arrived.add({header_of(7, number), false, octets, {}});
  const auto lacking = arrived.lacking();
  EXPECT_EQ(lacking.size(), kMostLacking);
  PostedPieces posted;
  for (int i = 0; i < 1000; ++i) posted.add(octets, false);
  std::vector<std::uint32_t> answered;
  posted.answer(lacking, SIZE_MAX, [&](const PostedPieces::Piece& piece) { answered.push_back(piece.number); });
  EXPECT_EQ(answered.front(), 1U);
  EXPECT_EQ(answered.back(), 1000U) << "the last number of a question stands for all after it";
  answered.clear();
  posted.answer(lacking, 16, [&](const PostedPieces::Piece& piece) { answered.push_back(piece.number); });
  EXPECT_EQ(answered.size(), 5U) << "the answer is bounded, too";
}

TEST(SeamPieces, SurviveTheWireAndNonsenseDoesNot) {
  Expected expected;
  expected.region_count = 2;
  const std::vector<std::byte> octets = {std::byte{1}, std::byte{2}};
  wire::SeamPiece sample;
  encode(header_of(7, 5), 9, octets, true, sample);
  const auto piece = decode(sample, expected);
  ASSERT_TRUE(std::holds_alternative<SeamPiece>(piece));
  EXPECT_EQ(std::get<SeamPiece>(piece).header.number, 5U);
  EXPECT_TRUE(std::get<SeamPiece>(piece).goes_on);
  EXPECT_TRUE(std::ranges::equal(std::get<SeamPiece>(piece).octets, octets));

  const auto is_sound = [&](std::vector<std::uint32_t> lacking) {
    encode(header_of(7, 0), 9, lacking, sample);
    return std::holds_alternative<SeamPiece>(decode(sample, expected));
  };
  EXPECT_TRUE(is_sound({1, 2, 7}));
  EXPECT_FALSE(is_sound({}));
  EXPECT_FALSE(is_sound({0, 2}));
  EXPECT_FALSE(is_sound({2, 2}));
  EXPECT_FALSE(is_sound(std::vector<std::uint32_t>(kMostLacking + 1, 1)));
  encode(header_of(7, 1), 9, std::vector<std::uint32_t>{1}, sample);
  EXPECT_FALSE(std::holds_alternative<SeamPiece>(decode(sample, expected))) << "a piece asks for nothing";
}

}  // namespace
}  // namespace aurasim::messages
