// What a run can be asked: each declared kind and field is read, and refused by name when it is wrong.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/limits.h"
#include "steering/ask_samples.h"

namespace aurasim::steering::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Kind>
Kind read_as(const std::string& text) {
  return std::get<Kind>(std::get<core::Ask>(read_ask(Json::parse(text), MeshFiles::kAllowed).what));
}

std::string refused(const std::string& text) { return refusal_of(Json::parse(text)); }

TEST(Asks, EveryKindIsReadWithEveryField) {
  for (const AskKind& kind : asks()) {
    EXPECT_EQ(refusal_of(whole_ask(kind)), "") << kind.name;
    for (const Field& field : kind.fields) EXPECT_EQ(refusal_of(ask_with(kind, field, sound_value(field))), "");
    EXPECT_EQ(read_ask(whole_ask(kind), MeshFiles::kAllowed).at_step, 400) << kind.name;
  }
}

TEST(Asks, EveryKindHasTheMeaningOfItsName) {
  const auto steering = [](const char* text) {
    return std::get<Steer>(read_ask(Json::parse(text), MeshFiles::kAllowed).what);
  };
  EXPECT_EQ(steering(R"({"kind":"pause"})").kind, messages::RunCommandKind::kPause);
  EXPECT_EQ(steering(R"({"kind":"stop"})").kind, messages::RunCommandKind::kStop);
  EXPECT_EQ(steering(R"({"kind":"step"})").count, 1);
  EXPECT_EQ(steering(R"({"kind":"step","count":7})").count, 7);
  EXPECT_EQ(std::get<Drain>(read_ask({{"kind", "drain"}, {"region", 2}}, MeshFiles::kAllowed).what).region,
            core::RegionId{2});
  EXPECT_EQ(read_as<core::SetRate>(R"({"kind":"rate","value":0.5})").rate, 0.5);
  EXPECT_EQ(read_as<core::ChangeScene>(R"({"kind":"scene","name":"tower"})").name, "tower");
  EXPECT_EQ(read_as<core::Save>(R"({"kind":"save","name":"a.cut"})").file, "a.cut");
  EXPECT_EQ(read_as<core::Load>(R"({"kind":"load","name":"a.cut"})").file, "a.cut");
  EXPECT_EQ(read_as<core::Load>(R"({"kind":"back"})").file, "") << "the newest earlier state";
  EXPECT_EQ(read_as<core::RemoveBody>(R"({"kind":"remove","body":7})").id, core::BodyId{7});
  EXPECT_EQ(read_as<core::RemoveStatic>(R"({"kind":"remove","static":7})").id, core::StaticId{7});
  EXPECT_EQ(read_as<core::Impulse>(R"({"kind":"impulse","body":7,"J":[0,0,1],"p":[1,1,1]})").p_W, core::Vec3(1, 1, 1));
  EXPECT_FALSE(read_as<core::Impulse>(R"({"kind":"impulse","body":7,"J":[0,0,1]})").p_W);
  EXPECT_FALSE(read_as<core::SetVelocity>(R"({"kind":"velocity","body":7,"v":[0,0,1]})").w_WB);
  EXPECT_EQ(read_as<core::Ray>(R"({"kind":"ray","from":[0,0,1],"to":[0,0,0]})").from_W.z(), 1);
  const auto regions = read_as<core::Repartition>(R"({"kind":"regions","boxes":[[null,null,0,null],[0,null,null,9]]})");
  EXPECT_EQ(regions.boxes[0].x1, 0);
  EXPECT_EQ(regions.boxes[1].y0, -kInfinity);
  EXPECT_EQ(regions.boxes[1].y1, 9);
  const auto moved = read_as<core::SendStatic>(R"({"kind":"move","static":2,"p":[0,0,3],"seconds":2})");
  EXPECT_EQ(moved.to.p_WB.z(), 3);
  EXPECT_EQ(moved.duration_s, 2);
}

TEST(Asks, NewBodiesAreOfAPrototypeOrHaveAShape) {
  const auto ball = read_as<core::NewBody>(R"({"kind":"spawn","prototype":"ball","p":[1,2,3],"v":[4,5,6]})");
  EXPECT_EQ(ball.prototype, "ball");
  EXPECT_FALSE(ball.shape);
  EXPECT_EQ(ball.pose.p_WB, core::Vec3(1, 2, 3));
  EXPECT_EQ(ball.v_WB, core::Vec3(4, 5, 6));
  const auto box =
      read_as<core::NewBody>(R"({"kind":"spawn","shape":{"kind":"box","size":[1,2,4]},"mass":3,"q":[0,2,0,0]})");
  EXPECT_EQ(std::get<core::Box>(*box.shape).half_extents, core::Vec3(0.5, 1, 2));
  EXPECT_EQ(box.mass_kg, 3);
  EXPECT_EQ(box.pose.q_WB.coeffs(), core::Quat(0, 1, 0, 0).coeffs()) << "of any length";
  EXPECT_THAT(refused(R"({"kind":"spawn"})"), HasSubstr("found none of prototype and shape"));
  EXPECT_THAT(refused(R"({"kind":"spawn","prototype":"a","shape":{"kind":"sphere","radius":1}})"),
              HasSubstr("found both of prototype and shape"));
  EXPECT_THAT(refused(R"({"kind":"spawn","prototype":"a","mass":1})"), HasSubstr("spawn.mass: goes with shape only"));
}

TEST(Asks, AMeshIsAFileOrAHash) {
  const Json file = {{"kind", "spawn"}, {"shape", {{"kind", "mesh"}, {"file", "/tmp/a.obj"}, {"as", "decomposition"}}}};
  const Ask ask = read_ask(file, MeshFiles::kAllowed);
  EXPECT_EQ(ask.mesh_file, "/tmp/a.obj");
  EXPECT_EQ(core::mesh_in(std::get<core::Ask>(ask.what))->use, core::MeshUse::kDecomposition);
  EXPECT_THAT(refusal_of(file, MeshFiles::kRefused), HasSubstr("spawn.shape.file: a page names a mesh by its hash"));
  const auto fixed = read_as<core::NewStatic>(R"({"kind":"static","shape":{"kind":"mesh","hash":"00000000000000ff"}})");
  EXPECT_EQ(std::get<core::MeshRef>(fixed.shape), (core::MeshRef{255, core::MeshUse::kTriangles}));
  EXPECT_THAT(refused(R"({"kind":"static","shape":{"kind":"mesh","hash":"00000000000000ff","as":"hull"}})"),
              StartsWith("static.shape.as"));
  EXPECT_THAT(refused(R"({"kind":"static","shape":{"kind":"mesh"}})"), HasSubstr("found none of file and hash"));
}

TEST(Asks, AStaticHasANameOrANumber) {
  core::Scene scene;
  core::StaticBody gate;
  gate.name = "gate";
  scene.statics = {{}, gate};
  for (const Json& named : {Json("gate"), Json("1"), Json(1)}) {
    Ask ask = read_ask({{"kind", "move"}, {"static", named}}, MeshFiles::kAllowed);
    look_up_static(ask, scene);
    EXPECT_EQ(std::get<core::SendStatic>(std::get<core::Ask>(ask.what)).id, core::StaticId{1}) << named;
  }
  Ask unknown = read_ask({{"kind", "remove"}, {"static", "door"}}, MeshFiles::kAllowed);
  EXPECT_THROW(look_up_static(unknown, scene), BadAsk);
}

/// Also what the fields of shapes may be.
TEST(Asks, EachWrongValueOfEachFieldIsRefusedByItsName) {
  int refusals = 0;
  for (const AskKind& kind : asks()) {
    std::vector<Field> fields = kind.fields;
    fields.push_back(at_field());
    for (const Field& field : fields) {
      for (const Json& value : wrong_values(field)) {
        const std::string why = refusal_of(ask_with(kind, field, value));
        EXPECT_THAT(why, StartsWith(std::string(kind.name) + "." + std::string(field.name))) << value;
        EXPECT_THAT(why, HasSubstr("allowed: ")) << value;
        ++refusals;
      }
    }
  }
  for (const ShapeKind& shape : shapes()) {
    for (const Field& field : shape.fields) {
      for (const Json& value : wrong_values(field)) {
        Json spawn = {{"kind", "spawn"}, {"shape", {{"kind", shape.name}}}};
        for (const Field& other : shape.fields) {
          if (other.name != "file" || field.name == "file")
            spawn["shape"][std::string(other.name)] = sound_value(other);
        }
        if (field.name == "file") spawn["shape"].erase("hash");
        spawn["shape"][std::string(field.name)] = value;
        EXPECT_THAT(refusal_of(spawn), StartsWith("spawn.shape." + std::string(field.name))) << value;
        ++refusals;
      }
    }
  }
  EXPECT_GT(refusals, 150);
}

TEST(Asks, WhatIsRequiredIsMissed) {
  for (const AskKind& kind : asks()) {
    for (const Field& field : kind.fields) {
      Json ask = whole_ask(kind);
      ask.erase(std::string(field.name));
      const bool is_needed = field.absent.empty() && field.name != kind.first;
      EXPECT_EQ(!refusal_of(ask).empty(), is_needed) << ask;
    }
  }
}

TEST(Asks, UnknownKindsAndFieldsAreNamed) {
  EXPECT_THAT(refused("1"), HasSubstr("ask: found 1"));
  EXPECT_THAT(refused("{}"), HasSubstr("kind: found nothing"));
  EXPECT_THAT(refused(R"({"kind":"fly"})"), HasSubstr(R"(kind: found "fly", allowed: pause, resume)"));
  EXPECT_THAT(refused(R"({"kind":"pause","now":1})"), HasSubstr(R"(pause: unknown field "now")"));
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"kind":"sphere","radius":1,"colour":1}})"),
              HasSubstr(R"(spawn.shape: unknown field "colour")"));
}

/// A shape can be wrong although each of its sizes is right.
TEST(Asks, ShapesAreThoseOfThings) {
  EXPECT_EQ(refused(R"({"kind":"spawn","shape":{"kind":"box","size":[1,1,0.002]}})"), "");
  EXPECT_THAT(refused(R"({"kind":"spawn","shape":{"kind":"box","size":[0.01,0.01,0.01]}})"), HasSubstr("radius"));
  EXPECT_THAT(refused(R"({"kind":"static","shape":{"kind":"box","size":[400,400,400]}})"), HasSubstr("radius"));
}

/// What comes over the wire has not been read from JSON: nodes refuse it with the same words.
TEST(Asks, NodesRefuseWithTheSameWords) {
  const core::Vec3 far(core::limits::kFarthestPlace_m * 2, 0, 0);
  core::NewBody body;
  body.shape = core::Sphere{1};
  const auto expect_same = [](const core::Ask& typed, const std::string& json) {
    EXPECT_FALSE(problem_with(typed).empty());
    EXPECT_EQ(problem_with(typed), refused(json));
  };
  body.mass_kg = 0;
  expect_same(body, R"({"kind":"spawn","shape":{"kind":"sphere","radius":1},"mass":0})");
  body.mass_kg = 1;
  body.pose.p_WB = far;
  expect_same(body, R"({"kind":"spawn","shape":{"kind":"sphere","radius":1},"p":[2e6,0,0]})");
  body.pose.p_WB = {};
  body.shape = core::Box{{1, 1, 1e-4}};
  expect_same(body, R"({"kind":"spawn","shape":{"kind":"box","size":[2,2,2e-4]}})");
  body.shape = core::Box{{0.005, 0.005, 0.005}};
  expect_same(body, R"({"kind":"spawn","shape":{"kind":"box","size":[0.01,0.01,0.01]}})");
  expect_same(core::Impulse{core::BodyId{1}, {1e8, 0, 0}, {}}, R"({"kind":"impulse","body":1,"J":[1e8,0,0]})");
  expect_same(core::SetVelocity{core::BodyId{1}, {1e8, 0, 0}, {}}, R"({"kind":"velocity","body":1,"v":[1e8,0,0]})");
  expect_same(core::SetRate{11}, R"({"kind":"rate","value":11})");
  expect_same(core::Ray{far, far, {}}, R"({"kind":"ray","from":[2e6,0,0],"to":[2e6,0,0]})");
  expect_same(core::Save{"../x"}, R"({"kind":"save","name":"../x"})");
  expect_same(core::ChangeScene{"../x"}, R"({"kind":"scene","name":"../x"})");
  expect_same(core::SendStatic{{}, {far, core::Quat::Identity()}, 0}, R"({"kind":"move","static":0,"p":[2e6,0,0]})");
  expect_same(core::Repartition{{{1, 0, 0, 1}}}, R"({"kind":"regions","boxes":[[1,0,0,1]]})");
}

TEST(Asks, NumbersThatAreNotFiniteAreRefused) {
  for (const double value : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(refusal_of({{"kind", "rate"}, {"value", value}}), "");
    EXPECT_NE(refusal_of({{"kind", "impulse"}, {"body", 1}, {"J", {value, 0, 0}}}), "");
    EXPECT_NE(problem_with(core::Impulse{core::BodyId{1}, {0, value, 0}, {}}), "");
    EXPECT_NE(problem_with(core::SetRate{value}), "");
  }
}

TEST(Asks, OnlyRaysChangeNothing) {
  for (const AskKind& kind : asks()) {
    EXPECT_EQ(changes_the_world(read_ask(whole_ask(kind), MeshFiles::kAllowed)), kind.name != "ray") << kind.name;
  }
}

}  // namespace
}  // namespace aurasim::steering::testing
