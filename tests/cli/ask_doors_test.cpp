// Whichever way an ask comes (the command line, the viewer's page, the agent of a client library), the same JSON is the
// same command, and what is wrong is refused in the same words.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/agent.h"
#include "cli/ask_options.h"
#include "overseer/page_input.h"
#include "steering/ask_samples.h"
#ifdef AURASIM_HAS_CLIENT
#include "client/asks.h"
#endif

namespace aurasim::cli {
namespace {

using core::Vec3;
using steering::Ask;
using steering::AskKind;
using steering::Field;
using steering::Form;
using Json = nlohmann::json;

std::string shown(const Vec3& v) { return fmt::format("({}, {}, {})", v.x(), v.y(), v.z()); }
std::string shown(const std::optional<Vec3>& v) { return v ? shown(*v) : "none"; }
std::string shown(const core::Pose& pose) {
  const core::Quat& q = pose.q_WB;
  return fmt::format("{} turned ({}, {}, {}, {})", shown(pose.p_WB), q.w(), q.x(), q.y(), q.z());
}

struct Shown {
  std::string operator()(const core::Sphere& s) const { return fmt::format("sphere {}", s.radius); }
  std::string operator()(const core::Box& s) const { return "box " + shown(s.half_extents); }
  std::string operator()(const core::Capsule& s) const { return fmt::format("capsule {} {}", s.radius, s.height); }
  std::string operator()(const core::Cylinder& s) const { return fmt::format("cylinder {} {}", s.radius, s.height); }
  std::string operator()(const core::MeshRef& s) const { return fmt::format("mesh {} {}", s.hash, int(s.use)); }

  std::string operator()(const core::NewBody& a) const {
    return fmt::format("body '{}' {} of {} kg at {} v {} w {}", a.prototype, a.shape ? std::visit(*this, *a.shape) : "",
                       a.mass_kg, shown(a.pose), shown(a.v_WB), shown(a.w_WB));
  }
  std::string operator()(const core::NewStatic& a) const { return std::visit(*this, a.shape) + " at " + shown(a.pose); }
  std::string operator()(const core::RemoveBody& a) const { return fmt::format("no body {}", core::value_of(a.id)); }
  std::string operator()(const core::RemoveStatic& a) const {
    return fmt::format("no static {}", core::value_of(a.id));
  }
  std::string operator()(const core::Impulse& a) const {
    return fmt::format("push {} J {} p {}", core::value_of(a.id), shown(a.J_W), shown(a.p_W));
  }
  std::string operator()(const core::SetVelocity& a) const {
    return fmt::format("velocity {} v {} w {}", core::value_of(a.id), shown(a.v_WB), shown(a.w_WB));
  }
  std::string operator()(const core::SetRate& a) const { return fmt::format("rate {}", a.rate); }
  std::string operator()(const core::Repartition& a) const {
    std::string text = "boxes";
    for (const core::Rectangle& box : a.boxes) text += fmt::format(" [{} {} {} {}]", box.x0, box.y0, box.x1, box.y1);
    return text;
  }
  std::string operator()(const core::ChangeScene& a) const { return "scene " + a.name; }
  std::string operator()(const core::Ray& a) const { return "ray " + shown(a.from_W) + shown(a.to_W); }
  std::string operator()(const core::Save& a) const { return "save " + a.file; }
  std::string operator()(const core::Load& a) const { return "load " + a.file; }
  std::string operator()(const core::SendStatic& a) const {
    return fmt::format("static {} to {} in {} s", core::value_of(a.id), shown(a.to), a.duration_s);
  }
  std::string operator()(const core::Ask& a) const { return std::visit(*this, a); }
  std::string operator()(const steering::Steer& a) const {
    return fmt::format("{} {}", messages::name_of(a.kind), a.count);
  }
  std::string operator()(const steering::Drain& a) const { return fmt::format("drain {}", core::value_of(a.region)); }
};

/// The whole ask as text, with its static looked up.
std::string shown(Ask ask) {
  steering::look_up_static(ask, {});
  return fmt::format("{}, file '{}', at {}", std::visit(Shown{}, ask.what), ask.mesh_file, ask.at_step);
}

/// What came through a door: the ask, or why it was refused.
std::string through_page(const Json& ask) {
  const Json message = {{"type", "command"}, {"request", "r"}, {"command", ask}};
  auto read = overseer::read_page_message(message.dump());
  if (const auto* bad = std::get_if<overseer::BadMessage>(&read)) return bad->why;
  return shown(std::get<overseer::CommandMessage>(std::get<overseer::PageMessage>(read)).ask);
}

std::string through_agent(const Json& ask) {
  try {
    return shown(agent::asks_of(Json::parse(Json{{"do", "ask"}, {"asks", {ask}}}.dump())).at(0));
  } catch (const steering::BadAsk& bad) {
    return bad.what();
  }
}

/// The words by which `aurasim send` is told this value; none: the command line cannot say it.
std::vector<std::string> words_of(const Field& field, const Json& value) {
  std::vector<std::string> words;
  if (!field.is_argument) words.push_back("--" + std::string(field.name));
  if (field.form == Form::kShape) {
    if (!value.is_object() || value.value("kind", "") != "box") return {};
    words[0] = "--size";
    for (const Json& side : value.at("size")) words.push_back(side.dump());
  } else if (field.form == Form::kBoxes) {
    if (!value.is_array() || value.empty()) return {};
    for (const Json& box : value) {
      if (!box.is_array() || box.size() != 4) return {};
      for (const Json& side : box) words.push_back(side.dump());
    }
  } else if (value.is_array()) {
    const std::size_t size = field.form == Form::kRotation ? 4 : 3;
    if (value.size() != size || !std::ranges::all_of(value, &Json::is_number)) return {};
    for (const Json& one : value) words.push_back(one.dump());
  } else if (value.is_string() && (field.form == Form::kText || field.form == Form::kFileName ||
                                   field.form == Form::kSaveName || field.form == Form::kStatic)) {
    if (value == "") return {};
    words.push_back(value.get<std::string>());
  } else if (field.form == Form::kNumber ? value.is_number() : value.is_number_integer() && value >= 0 && value < 1e6) {
    if (field.form != Form::kNumber && field.form != Form::kWhole && field.form != Form::kStatic) return {};
    words.push_back(value.dump());
  } else {
    return {};
  }
  return words;
}

/// Nothing: the command line cannot say this ask.
std::optional<std::string> through_send(const AskKind& kind, const Json& ask) {
  std::vector<std::string> words;
  std::vector<Field> fields = kind.fields;
  fields.push_back(steering::at_field());
  for (const Field& field : fields) {
    const auto value = ask.find(std::string(field.name));
    if (value == ask.end()) continue;
    const std::vector<std::string> added = words_of(field, *value);
    if (added.empty()) return std::nullopt;
    words.insert(words.end(), added.begin(), added.end());
  }
  CLI::App app;
  AskOptions options(kind);
  options.add_to(app);
  std::ranges::reverse(words);
  try {
    app.parse(words);
    return shown(steering::read_ask(options.ask(), steering::MeshFiles::kAllowed));
  } catch (const steering::BadAsk& bad) {
    return bad.what();
  } catch (const CLI::ParseError&) {
    return std::nullopt;
  }
}

TEST(AskDoors, TheSameJsonIsTheSameCommandThroughEach) {
  for (const AskKind& kind : steering::asks()) {
    for (const Field& field : kind.fields) {
      const Json ask = steering::testing::ask_with(kind, field, steering::testing::sound_value(field));
      const std::string expected = shown(steering::read_ask(ask, steering::MeshFiles::kAllowed));
      EXPECT_EQ(through_page(ask), expected) << ask;
      EXPECT_EQ(through_agent(ask), expected) << ask;
      EXPECT_EQ(through_send(kind, ask), expected) << ask;
    }
    const Json bare = {{"kind", kind.name}};
    EXPECT_EQ(through_page(bare), through_agent(bare));
  }
}

TEST(AskDoors, WhatIsWrongIsRefusedInTheSameWordsByEach) {
  int by_two = 0, by_three = 0;
  for (const AskKind& kind : steering::asks()) {
    for (const Field& field : kind.fields) {
      for (const Json& value : steering::testing::wrong_values(field)) {
        const Json ask = steering::testing::ask_with(kind, field, value);
        const std::string expected = steering::testing::refusal_of(ask);
        EXPECT_NE(expected, "") << ask;
        EXPECT_EQ(through_page(ask), expected) << ask;
        EXPECT_EQ(through_agent(ask), expected) << ask;
        ++by_two;
        const auto sent = through_send(kind, ask);
        if (!sent) continue;
        EXPECT_EQ(*sent, expected) << ask;
        ++by_three;
      }
    }
  }
  std::printf("%d refusals by page and agent, %d of them by the command line, too\n", by_two, by_three);
  EXPECT_GT(by_three, 25);
}

TEST(AskDoors, OnlyAPageMayNotNameAFile) {
  const Json ask = {{"kind", "spawn"}, {"shape", {{"kind", "mesh"}, {"file", "/a.obj"}}}};
  EXPECT_THAT(through_page(ask), ::testing::HasSubstr("/api/shapes"));
  EXPECT_THAT(through_agent(ask), ::testing::HasSubstr("file '/a.obj'"));
}

#ifdef AURASIM_HAS_CLIENT
TEST(AskDoors, TheClientLibrarySaysWhatTheOthersSay) {
  using namespace client;
  const auto expect_same = [](const Json& made, const char* text) {
    EXPECT_EQ(through_agent(made), through_agent(Json::parse(text)));
    EXPECT_THAT(through_agent(made), ::testing::Not(::testing::HasSubstr("found"))) << made;
  };
  expect_same(
      spawn_json({.shape = Shape::box({1, 2, 3}), .mass_kg = 3, .position = {1, 2, 3}, .rotation = {0, 1, 0, 0}}),
      R"({"kind":"spawn","shape":{"kind":"box","size":[1,2,3]},"mass":3,"p":[1,2,3],"q":[0,1,0,0]})");
  expect_same(spawn_json({.prototype = "ball", .linear_velocity = {1, 0, 0}, .angular_velocity = {0, 0, 2}}),
              R"({"kind":"spawn","prototype":"ball","v":[1,0,0],"w":[0,0,2]})");
  expect_same(spawn_json({.shape = Shape::capsule(0.5, 2)}),
              R"({"kind":"spawn","shape":{"kind":"capsule","radius":0.5,"height":2}})");
  expect_same(spawn_json({.shape = Shape::mesh("/a.obj", true)}),
              R"({"kind":"spawn","shape":{"kind":"mesh","file":"/a.obj","as":"decomposition"}})");
  expect_same(static_json({.shape = Shape::sphere(2), .position = {0, 0, 1}}),
              R"({"kind":"static","shape":{"kind":"sphere","radius":2},"p":[0,0,1]})");
  expect_same(static_json({.shape = Shape::mesh("/a.obj", true)}),
              R"({"kind":"static","shape":{"kind":"mesh","file":"/a.obj"}})");
  expect_same(move_json(std::uint32_t{2}, {0, 0, 3}, {1, 0, 0, 0}, 2),
              R"({"kind":"move","static":2,"p":[0,0,3],"seconds":2})");
  expect_same(impulse_json(3, {0, 0, 20}, client::Vec3{1, 1, 1}),
              R"({"kind":"impulse","body":3,"J":[0,0,20],"p":[1,1,1]})");
  expect_same(impulse_json(3, {0, 0, 20}, {}), R"({"kind":"impulse","body":3,"J":[0,0,20]})");
  expect_same(velocity_json(3, {0, 0, 8}, {}), R"({"kind":"velocity","body":3,"v":[0,0,8]})");
  const double infinity = std::numeric_limits<double>::infinity();
  expect_same(regions_json({{-infinity, -infinity, 0, infinity}, {0, -5, infinity, 5}}),
              R"({"kind":"regions","boxes":[[null,null,0,null],[0,-5,null,5]]})");
  expect_same(ask_json("back"), R"({"kind":"back"})");
}
#endif

}  // namespace
}  // namespace aurasim::cli
