// The packed statics of a scene (core/static_list.h).
#include "core/static_list.h"

#include <algorithm>
#include <bit>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

namespace aurasim::core {
namespace {

constexpr std::size_t kMany = 5000;

std::vector<std::uint64_t> bits(const Vec3& v) {
  std::vector<std::uint64_t> bits;
  for (int i = 0; i < 3; ++i) bits.push_back(std::bit_cast<std::uint64_t>(v[i]));
  return bits;
}

std::vector<std::uint64_t> bits(const Pose& pose) {
  std::vector<std::uint64_t> all = bits(pose.p_WB);
  for (const double x : {pose.q_WB.w(), pose.q_WB.x(), pose.q_WB.y(), pose.q_WB.z()}) {
    all.push_back(std::bit_cast<std::uint64_t>(x));
  }
  return all;
}

void expect_same(const StaticBody& a, const StaticBody& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.shape, b.shape);
  EXPECT_EQ(a.material, b.material);
  EXPECT_EQ(bits(a.pose), bits(b.pose));
  EXPECT_EQ(bits(a.belt_S), bits(b.belt_S));
  EXPECT_EQ(a.moves(), b.moves());
  ASSERT_EQ(a.path.has_value(), b.path.has_value());
  if (!a.path) return;
  EXPECT_EQ(a.path->repeats, b.path->repeats);
  EXPECT_EQ(a.path->smooth, b.path->smooth);
  ASSERT_EQ(a.path->stops.size(), b.path->stops.size());
  for (std::size_t i = 0; i < a.path->stops.size(); ++i)
    EXPECT_EQ(bits(a.path->stops[i].X_SP), bits(b.path->stops[i].X_SP));
}

/// Statics of all kinds: with and without name, path and belt, turned or not, and with -0.
std::vector<StaticBody> statics_of_all_kinds() {
  std::mt19937_64 random(3);
  const auto one_in = [&random](unsigned n) { return random() % n == 0; };
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<StaticBody> statics;
  for (std::size_t i = 0; i < kMany; ++i) {
    StaticBody& body = statics.emplace_back();
    body.name = one_in(3) ? "thing " + std::to_string(i) : StaticList::usual_name(i);
    if (one_in(50)) body.name = StaticList::usual_name(i + 7);
    body.shape = static_cast<std::uint32_t>(random() % 5), body.material = static_cast<std::uint32_t>(random() % 3);
    body.pose.p_WB = {any(random), one_in(4) ? -0.0 : any(random), any(random)};
    if (one_in(2)) body.pose.q_WB = Quat(any(random), any(random), any(random), any(random)).normalized();
    if (one_in(5)) body.pose.q_WB = Quat(1, -0.0, 0, 0);
    if (one_in(20)) body.belt_S = {any(random), 0, 0};
    if (one_in(20)) body.path = StaticPath{{{1, {{0, 0, any(random)}, body.pose.q_WB}}}, one_in(2), one_in(2)};
  }
  return statics;
}

StaticList listed(const std::vector<StaticBody>& statics) {
  StaticList list;
  for (const StaticBody& body : statics) list.push_back(body);
  return list;
}

std::size_t bytes_in_use() { return mallinfo2().uordblks + mallinfo2().hblkhd; }

TEST(StaticList, ReturnsEveryBitOfAStatic) {
  const std::vector<StaticBody> statics = statics_of_all_kinds();
  const StaticList list = listed(statics);
  ASSERT_EQ(list.size(), kMany);
  std::size_t i = 0;
  for (const StaticBody& body : list) {
    expect_same(body, statics[i]);
    EXPECT_EQ(list.shape(i), statics[i].shape);
    EXPECT_EQ(bits(list.pose(i)), bits(statics[i].pose));
    EXPECT_EQ(list.moves(i), statics[i].moves());
    ++i;
  }
  EXPECT_EQ(i, kMany);
}

TEST(StaticList, FindsTheFirstOfAName) {
  const std::vector<StaticBody> statics = statics_of_all_kinds();
  const StaticList list = listed(statics);
  for (std::size_t i = 0; i < kMany + 20; i += 3) {
    for (const std::string& name : {StaticList::usual_name(i), "thing " + std::to_string(i)}) {
      const auto first = std::ranges::find(statics, name, &StaticBody::name);
      const auto place = static_cast<std::size_t>(first - statics.begin());
      EXPECT_EQ(list.find(name), place < kMany ? std::optional(place) : std::nullopt) << name;
    }
  }
  for (const char* none : {"static", "static ", "static 01", "static -1", "static 3x", "thing", ""}) {
    EXPECT_EQ(list.find(none), std::nullopt) << none;
  }
}

TEST(StaticList, ACopyGrowsAndChangesAlone) {
  std::vector<StaticBody> statics = statics_of_all_kinds();
  const StaticList list = listed(statics);
  StaticList copy = list;
  StaticBody added;
  added.name = "new";
  copy.push_back(added);
  copy.change(700, [](StaticBody& body) { body.name = "other", body.shape = 77; });
  EXPECT_EQ(list.size(), kMany);
  EXPECT_EQ(copy.size(), kMany + 1);
  EXPECT_EQ(copy.back().name, "new");
  for (std::size_t i = 0; i < kMany; ++i) expect_same(list[i], statics[i]);
  statics[700].name = "other", statics[700].shape = 77;
  for (std::size_t i = 0; i < kMany; ++i) expect_same(copy[i], statics[i]);
}

/// Memory of a node that reads a world with so many statics, and copies its scene.
TEST(StaticList, TakesLittleMemoryAndCopiesTakeNone) {
  constexpr std::size_t kWorld = 100'000;
  const std::size_t before = bytes_in_use();
  StaticList list;
  for (std::size_t i = 0; i < kWorld; ++i) {
    StaticBody tile;
    tile.name = StaticList::usual_name(i);
    tile.pose.p_WB = {static_cast<double>(i), 0, 0};
    list.push_back(tile);
  }
  const std::size_t one = bytes_in_use() - before;
  EXPECT_LT(one, 40 * kWorld);
  const std::vector<StaticList> copies(10, list);
  EXPECT_LE(bytes_in_use() - before - one, one / 2);
}

}  // namespace
}  // namespace aurasim::core
