// What pages send: read if it is sound, refused with a text that names what is not.
#include "overseer/page_input.h"

#include <iostream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "physics/hull_triangles.h"

namespace aurasim::overseer {
namespace {

using ::testing::HasSubstr;

std::variant<PageMessage, BadMessage> read_command(const std::string& command) {
  return read_page_message(R"({"type":"command","request":"r","command":)" + command + "}");
}

/// Why it is refused.
std::string refused(const std::string& command) {
  auto read = read_command(command);
  const auto* bad = std::get_if<BadMessage>(&read);
  if (bad == nullptr) return "nothing is wrong with it";
  EXPECT_EQ(bad->request, "r") << "so that it can be answered";
  return bad->why;
}

/// Which asks there are, and what is wrong with them: tests/steering, tests/cli/ask_doors_test.cpp.
TEST(PageInput, ACommandIsAnAsk) {
  const auto read = read_command(R"({"kind":"step","count":7})");
  const auto& message = std::get<CommandMessage>(std::get<PageMessage>(read));
  EXPECT_EQ(message.request, "r");
  EXPECT_EQ(std::get<steering::Steer>(message.ask.what).count, 7);
}

TEST(PageInput, WhatIsWrongIsSaid) {
  EXPECT_THAT(refused("1"), HasSubstr("found 1"));
  EXPECT_THAT(refused(R"({"kind":"fly"})"), HasSubstr(R"(found "fly")"));
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"kind":"mesh","file":"/etc/passwd"}})"), HasSubstr("/api/shapes"));
  const auto why = [](const std::string& text) {
    const auto read = read_page_message(text);
    const auto* const bad = std::get_if<BadMessage>(&read);
    return bad != nullptr ? bad->why : "nothing is wrong with it";
  };
  EXPECT_THAT(why("1"), HasSubstr("message: found 1, allowed: an object"));
  EXPECT_THAT(why(R"({"type":"fly"})"), HasSubstr(R"(type: found "fly")"));
  EXPECT_THAT(why(R"({"type":"show","auras":1})"), HasSubstr("auras: found 1"));
  EXPECT_THAT(why(R"({"type":"show","walls":true})"), HasSubstr(R"("walls")"));
  EXPECT_THAT(why(R"({"type":"view","eye":[0,0,1e9],"towards":[1,0,0],"half_angle":1,"pixel":0})"), HasSubstr("eye"));
  EXPECT_THAT(why(R"({"type":"view","eye":[0,0,1],"towards":[0,0,0],"half_angle":1,"pixel":0})"), HasSubstr("towards"));
  EXPECT_THAT(why(R"({"type":"view","eye":[0,0,1],"towards":[1,0,0],"half_angle":9,"pixel":0})"),
              HasSubstr("half_angle"));
  EXPECT_THAT(why(R"({"type":"watch"})"), HasSubstr("slot"));
  EXPECT_THAT(why(R"({"type":"replay","action":"speed","value":0})"), HasSubstr("value: found 0"));
  EXPECT_THAT(why(R"({"type":"replay","action":"fly"})"), HasSubstr("action"));
}

TEST(PageInput, OtherMessagesAreRead) {
  EXPECT_TRUE(std::get<Show>(std::get<PageMessage>(read_page_message(R"({"type":"show","auras":true})"))).auras);
  EXPECT_EQ(std::get<Watch>(std::get<PageMessage>(read_page_message(R"({"type":"watch","slot":3})"))).slot, 3U);
  EXPECT_FALSE(std::get<Watch>(std::get<PageMessage>(read_page_message(R"({"type":"watch","slot":null})"))).slot);
  const auto seek = read_page_message(R"({"type":"replay","action":"seek","value":120})");
  EXPECT_EQ(std::get<ReplayControl>(std::get<PageMessage>(seek)).value, 120);
}

TEST(PageInput, DeepAndLongTextsDoNoHarm) {
  EXPECT_TRUE(std::holds_alternative<BadMessage>(read_page_message(std::string(60'000, '['))));
  EXPECT_TRUE(std::holds_alternative<BadMessage>(read_page_message(std::string(kLongestMessage + 1, ' '))));
  EXPECT_TRUE(std::holds_alternative<BadMessage>(read_page_message("\xff\xfe\x00")));
  EXPECT_TRUE(std::holds_alternative<BadMessage>(read_command(R"({"kind":"rate","value":1e400})")));
  EXPECT_TRUE(std::holds_alternative<BadMessage>(read_command(R"({"kind":"rate","value":NaN})")));
}

TEST(PageInput, MutationsAreReadOrRefusedAndNeverThrow) {
  const std::string original = R"({"type":"command","request":"r","command":{"kind":"spawn","shape":{"kind":"box",)"
                               R"("size":[1,2,3]},"mass":2.5,"p":[0,0,-1e3],"q":[1,0,0,0],"v":[1,2,3]}})";
  std::mt19937 random(11);
  std::cout << "seed 11\n";
  const std::string letters = R"({}[]":,0123456789.-eEntf \)" + std::string("\x00\xff", 2);
  int accepted = 0;
  for (int i = 0; i < 50'000; ++i) {
    std::string text = original;
    for (std::size_t k = 0; k < 1 + random() % 3; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0) text.erase(at, 1 + random() % 4);
      if (!text.empty()) text[random() % text.size()] = letters[random() % letters.size()];
    }
    accepted += std::holds_alternative<PageMessage>(read_page_message(text));
  }
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 25'000);
}

TEST(ConvexHull, OfABoxHasTwelveTrianglesThatFaceOutwards) {
  std::vector<core::Vec3> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  points.emplace_back(0.5, 0.5, 0.5);
  const auto triangles = physics::hull_triangles(points);
  EXPECT_EQ(triangles.size(), 12U);
  double volume = 0;
  for (const auto& t : triangles) volume += points[t[0]].dot(points[t[1]].cross(points[t[2]])) / 6;
  EXPECT_NEAR(volume, 1, 1e-12);
}

/// Bullet rounds the points to a grid of 0.2 mm, for a sphere of 1 m, before it looks for the hull. A thin triangle
/// leans by more than that.
TEST(ConvexHull, OfManyPointsOnASphereHoldsThemAll) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<core::Vec3> points;
  for (int i = 0; i < 200; ++i)
    points.push_back(core::Vec3(normal(random), normal(random), normal(random)).normalized());
  const auto triangles = physics::hull_triangles(points);
  EXPECT_EQ(triangles.size(), 2 * points.size() - 4) << "Euler";
  for (const auto& t : triangles) {
    const core::Vec3 normal_of = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).normalized();
    for (const core::Vec3& p : points) EXPECT_LT(normal_of.dot(p - points[t[0]]), 1e-2);
  }
}

TEST(ConvexHull, OfPointsInAPlaneIsNone) {
  EXPECT_TRUE(physics::hull_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}).empty());
  EXPECT_TRUE(physics::hull_triangles({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).empty());
  EXPECT_TRUE(physics::hull_triangles({}).empty());
}

}  // namespace
}  // namespace aurasim::overseer
