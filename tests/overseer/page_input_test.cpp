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

template <class Kind>
Kind sound(const std::string& command) {
  auto read = read_command(command);
  if (const auto* bad = std::get_if<BadMessage>(&read)) throw std::runtime_error(command + ": " + bad->why);
  return std::get<Kind>(std::get<CommandMessage>(std::get<PageMessage>(read)).command);
}

/// Why it is refused.
std::string refused(const std::string& command) {
  auto read = read_command(command);
  const auto* bad = std::get_if<BadMessage>(&read);
  if (bad == nullptr) return "nothing is wrong with it";
  EXPECT_EQ(bad->request, "r") << "so that it can be answered";
  return bad->why;
}

TEST(PageInput, EveryKindOfCommandIsRead) {
  sound<Pause>(R"({"kind":"pause"})");
  sound<Resume>(R"({"kind":"resume"})");
  sound<Reset>(R"({"kind":"reset"})");
  EXPECT_EQ(sound<StepOn>(R"({"kind":"step"})").count, 1);
  EXPECT_EQ(sound<SetRate>(R"({"kind":"rate","value":0.5})").value, 0.5);
  EXPECT_EQ(sound<LoadScene>(R"({"kind":"scene","name":"tower"})").name, "tower");
  EXPECT_EQ(sound<SaveWorld>(R"({"kind":"save","name":"a.cut"})").name, "a.cut");
  EXPECT_EQ(sound<LoadWorld>(R"({"kind":"load","name":"a.cut"})").name, "a.cut");
  sound<StepBack>(R"({"kind":"back"})");
  const auto regions = sound<SetRegions>(R"({"kind":"regions","boxes":[[null,null,0,null],[0,null,null,null]]})");
  EXPECT_EQ(regions.boxes[0].x1, 0);
  EXPECT_EQ(regions.boxes[1].y0, -std::numeric_limits<double>::infinity());
  const auto spawn = sound<Spawn>(R"({"kind":"spawn","prototype":"ball","p":[1,2,3],"v":[4,5,6]})");
  EXPECT_EQ(std::get<std::string>(spawn.kind), "ball");
  EXPECT_EQ(spawn.pose.p_WB, core::Vec3(1, 2, 3));
  EXPECT_EQ(spawn.v_WB, core::Vec3(4, 5, 6));
  const auto box = sound<Spawn>(
      R"({"kind":"spawn","shape":{"kind":"box","half_extents":[1,1,2]},"mass_kg":3,"p":[0,0,0],"q":[0,1,0,0]})");
  EXPECT_EQ(std::get<NewKind>(box.kind).mass_kg, 3);
  const auto stored =
      sound<Spawn>(R"({"kind":"spawn","shape":{"hash":"00000000000000ff","as":"hull"},"mass_kg":3,"p":[0,0,0]})");
  EXPECT_EQ(std::get<StoredShape>(std::get<NewKind>(stored.kind).shape).hash, 255U);
  sound<PlaceStatic>(R"({"kind":"static","shape":{"hash":"00000000000000ff"},"p":[0,0,0]})");
  sound<PlaceStatic>(R"({"kind":"static","shape":{"kind":"plane","normal":[0,0,1],"offset":0},"p":[0,0,0]})");
  EXPECT_EQ(std::get<core::BodyId>(sound<Remove>(R"({"kind":"remove","body":7})").what), core::BodyId{7});
  EXPECT_EQ(sound<Impulse>(R"({"kind":"impulse","body":7,"J":[0,0,1],"p":[1,1,1]})").p_W, core::Vec3(1, 1, 1));
  EXPECT_FALSE(sound<SetVelocity>(R"({"kind":"velocity","body":7,"v":[0,0,1]})").w_WB);
  EXPECT_EQ(sound<CastRay>(R"({"kind":"ray","from":[0,0,1],"to":[0,0,0]})").from.z(), 1);
}

TEST(PageInput, WhatIsWrongIsSaid) {
  EXPECT_THAT(refused("1"), HasSubstr("not an object"));
  EXPECT_THAT(refused("{}"), HasSubstr("kind is missing"));
  EXPECT_THAT(refused(R"({"kind":"fly"})"), HasSubstr("'fly' is unknown"));
  EXPECT_THAT(refused(R"({"kind":"pause","now":1})"), HasSubstr("'now' is unknown"));
  EXPECT_THAT(refused(R"({"kind":"step","count":0})"), HasSubstr("count"));
  EXPECT_THAT(refused(R"({"kind":"step","count":1.5})"), HasSubstr("count"));
  EXPECT_THAT(refused(R"({"kind":"step","count":18446744073709551615})"), HasSubstr("count"));
  EXPECT_THAT(refused(R"({"kind":"rate","value":0})"), HasSubstr("value"));
  EXPECT_THAT(refused(R"({"kind":"scene","name":"../x"})"), HasSubstr("name"));
  EXPECT_THAT(refused(R"({"kind":"save","name":"../x"})"), HasSubstr("name"));
  EXPECT_THAT(refused(R"({"kind":"load"})"), HasSubstr("name"));
  EXPECT_THAT(refused(R"({"kind":"back","name":"../x"})"), HasSubstr("name"));
  EXPECT_THAT(refused(R"({"kind":"regions","boxes":[[1,0,0,1]]})"), HasSubstr("inside out"));
  EXPECT_THAT(refused(R"({"kind":"regions","boxes":[]})"), HasSubstr("boxes"));
  EXPECT_THAT(refused(R"({"kind":"spawn","p":[0,0,0]})"), HasSubstr("either prototype or shape"));
  EXPECT_THAT(refused(R"({"kind":"spawn","prototype":"a","p":[0,0]})"), HasSubstr("p is not"));
  EXPECT_THAT(refused(R"({"kind":"spawn","prototype":"a","p":[0,0,1e300]})"), HasSubstr("p is beyond"));
  EXPECT_THAT(refused(R"({"kind":"spawn","prototype":"a","p":[0,0,0],"q":[0,0,0,0]})"), HasSubstr("length 1"));
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"kind":"sphere","radius":0},"mass_kg":1,"p":[0,0,0]})"),
              HasSubstr("radius"));
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"kind":"sphere","radius":1},"mass_kg":-1,"p":[0,0,0]})"),
              HasSubstr("mass_kg"));
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"hash":"xyz","as":"hull"},"mass_kg":1,"p":[0,0,0]})"),
              HasSubstr("hash"));
  EXPECT_THAT(refused(R"({"kind":"static","shape":{"kind":"compound","parts":[{"shape":{"kind":"plane","normal":[0,0,1],
              "offset":0},"p":[0,0,0]}]},"p":[0,0,0]})"),
              HasSubstr("not convex"));
  EXPECT_THAT(
      refused(R"({"kind":"static","shape":{"kind":"mesh","points":[0,0,0,1,0,0,0,1,0,0,0,1],"triangles":[0,1,9]},
              "p":[0,0,0]})"),
      HasSubstr("triangles"));
  EXPECT_THAT(refused(R"({"kind":"remove","body":1,"static":2})"), HasSubstr("either body or static"));
  EXPECT_THAT(refused(R"({"kind":"remove","body":-1})"), HasSubstr("body"));
  EXPECT_THAT(refused(R"({"kind":"velocity","body":1,"v":["a",0,0]})"), HasSubstr("v is not a number"));
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
  const std::string original =
      R"({"type":"command","request":"r","command":{"kind":"spawn","shape":{"kind":"compound","parts":)"
      R"([{"shape":{"kind":"box","half_extents":[1,2,3]},"p":[0,0,1],"q":[1,0,0,0]}]},"mass_kg":2.5,"p":[0,0,-1e3]}})";
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
