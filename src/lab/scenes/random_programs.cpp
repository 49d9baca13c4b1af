#include "lab/scenes/random_programs.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr std::uint32_t kFirstWord = 20, kLastWord = 330;

/// One program: some bodies and joints that it steers, for some time, in its own rhythm.
class ProgramWriter {
 public:
  ProgramWriter(const Makings& makings, const Json& scene, int lookahead, Chance& chance)
      : makings_(makings), scene_(scene), lookahead_(lookahead), chance_(chance) {}

  /// Writes all setpoints of the program.
  void write(std::uint64_t client, Json& said) {
    constexpr std::array<std::uint32_t, 6> kRhythms = {1, 1, 2, 5, 20, 45};
    const std::array<std::uint32_t, 5> leads = {1, 2, k() + 1, k() + 2, 8};
    const std::uint32_t rhythm = kRhythms[chance_.below(kRhythms.size())], lead = leads[chance_.below(leads.size())];
    choose_whom();
    std::uint32_t word = kFirstWord + chance_.below(150);
    const std::uint32_t end = std::min(word + 30 + chance_.below(200), kLastWord);
    for (; word < end; word += rhythm) say(client, word, lead, false, said);
    if (chance_.below(2) == 0) say(client, end, lead, true, said);  // or it dies
  }

 private:
  struct Steered {
    Json body;
    std::string quantity;
    double size = 0;
  };

  std::uint32_t k() const { return static_cast<std::uint32_t>(lookahead_); }
  std::uint32_t any_of(const Json& list) { return chance_.below(static_cast<std::uint32_t>(list.size())); }
  double mass_of(const Json& body) const {
    return std::ranges::find(makings_.kinds.all, body["prototype"].get<std::string>(), &Kind::name)->mass_kg;
  }

  void choose_whom() {
    bodies_.clear();
    joints_.clear();
    const Json& all = scene_["bodies"];
    for (std::uint32_t left = 1 + chance_.below(6); left > 0; --left) {
      const Json& body = all[any_of(all)];
      const double mass = mass_of(body), speed = makings_.speed_m_s;
      const std::array<Steered, 5> ways = {{{body["id"], "force", 25 * mass},
                                            {body["id"], "torque", 5 * mass * makings_.kinds.all[0].half_height_m},
                                            {body["id"], "velocity", 0.6 * speed},
                                            {body["id"], "spin", 12},
                                            {body["id"], "driving", 0.3 * speed}}};
      bodies_.push_back(ways[chance_.below(ways.size())]);
    }
    for (const Json& joint : scene_["joints"]) {
      if ((joint.contains("hinge") || joint.contains("slider")) && chance_.below(2) == 0) {
        joints_.push_back(joint["name"]);
      }
    }
  }

  Json value_of(const Steered& steered) {
    if (steered.quantity == "driving") {
      return json_vec3(
          {steered.size * chance_.between(-1, 1), steered.size * chance_.between(-1, 1), chance_.between(-4, 4)});
    }
    const Vec3 share = {chance_.between(-1, 1), chance_.between(-1, 1), chance_.between(-0.3, 0.6)};
    return json_vec3(steered.size * share);
  }

  /// Position, speed, stiffness, damping, effort and the most of it (core/joint.h).
  Json drive() {
    constexpr std::array kStiffness = {0.0, 20.0, 400.0}, kMost = {2.0, 50.0, 2000.0};
    return {rounded(chance_.between(-1.5, 1.5)),
            rounded(chance_.between(-8, 8)),
            kStiffness[chance_.below(kStiffness.size())],
            rounded(chance_.between(0, 10)),
            chance_.below(3) == 0 ? rounded(chance_.between(-20, 20)) : 0.0,
            kMost[chance_.below(kMost.size())]};
  }

  void say(std::uint64_t client, std::uint32_t word, std::uint32_t lead, bool lets_go, Json& said) {
    Json one = {{"client", client}, {"said_step", word}, {"at_step", word + lead}};
    one["bodies"] = Json::array();
    for (const Steered& steered : bodies_) {
      Json& entry = one["bodies"].emplace_back(Json{{"body", steered.body}, {"quantity", steered.quantity}});
      if (!lets_go) entry["value"] = value_of(steered);
    }
    one["joints"] = Json::array();
    for (const std::string& joint : joints_) {
      Json& entry = one["joints"].emplace_back(Json{{"joint", joint}});
      if (!lets_go) entry["drive"] = drive();
    }
    said.push_back(std::move(one));
  }

  const Makings& makings_;
  const Json& scene_;
  int lookahead_;
  Chance& chance_;
  std::vector<Steered> bodies_;
  std::vector<std::string> joints_;
};

}  // namespace

Json random_programs(const Makings& makings, const Json& scene, int lookahead, Chance& chance) {
  Json said = Json::array();
  ProgramWriter writer(makings, scene, lookahead, chance);
  const std::uint32_t programs = 1 + chance.below(3);
  for (std::uint32_t i = 1; i <= programs; ++i) writer.write(i, said);
  return said;
}

Json random_movers(const std::vector<std::string>& statics, const Json& scene, int lookahead, Chance& chance) {
  constexpr std::uint64_t kClient = 9;
  constexpr std::array<std::uint32_t, 4> kRhythms = {1, 2, 10, 40};
  const auto k = static_cast<std::uint32_t>(lookahead);
  const std::array<std::uint32_t, 5> leads = {1, 2, k + 1, k + 2, 8};
  Json said = Json::array();
  for (const std::string& name : statics) {
    const auto body = std::ranges::find(scene["statics"], name, [](const Json& one) { return one.value("name", ""); });
    const Json& place = (*body)["position"];
    Vec3 p(place[0], place[1], place[2]);
    const std::uint32_t rhythm = kRhythms[chance.below(kRhythms.size())], lead = leads[chance.below(leads.size())];
    const double speed = chance.between(0.2, 3) * rhythm / 60;
    Vec3 way = {chance.between(-1, 1), chance.between(-1, 1), chance.between(-0.2, 0.4)};
    std::uint32_t word = kFirstWord + chance.below(100);
    const std::uint32_t end = std::min(word + 30 + chance.below(200), kLastWord);
    for (; word < end; word += rhythm) {
      if (chance.below(20) == 0) way = -way;
      p += speed * way;
      Json one = {{"client", kClient}, {"said_step", word}, {"at_step", word + lead}};
      for (const char* list : {"bodies", "joints", "statics"}) one[list] = Json::array();
      const std::uint32_t states = chance.below(4) == 0 ? 2 * rhythm : rhythm;
      one["statics"].push_back(Json{{"static", name}, {"position", json_vec3(p)}, {"states", states}});
      said.push_back(std::move(one));
    }
  }
  return said;
}

Json random_control_rules(Chance& chance) {
  constexpr std::array kOnSilence = {"hold", "zero", "last"};
  return {{"on_silence", kOnSilence[chance.below(kOnSilence.size())]}, {"silence", rounded(chance.between(0.1, 1))}};
}

}  // namespace aurasim::lab
