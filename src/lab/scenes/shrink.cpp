#include "lab/scenes/shrink.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <utility>

namespace aurasim::lab {
namespace {

using Clock = std::chrono::steady_clock;

bool fails_like(const WorldOutcome& outcome, const WorldOutcome& failure) {
  if (!failure.error.empty()) return outcome.error == failure.error;
  return failure.first_difference ? outcome.first_difference.has_value() : outcome.has_failed();
}

/// A list of a world whose entries can be left out.
struct Part {
  Json World::*file;
  const char* key;

  /// Null if the world has none.
  Json* in(World& world) const {
    Json& json = world.*file;
    return json.contains(key) ? &json[key] : nullptr;
  }
  std::size_t size_in(World& world) const {
    const Json* const entries = in(world);
    return entries != nullptr ? entries->size() : 0;
  }
};
constexpr Part kOrders = {&World::interference, "orders"}, kPrograms = {&World::interference, "programs"},
               kInjectors = {&World::scene, "injectors"}, kJoints = {&World::scene, "joints"},
               kBodies = {&World::scene, "bodies"}, kStatics = {&World::scene, "statics"},
               kPrototypes = {&World::scene, "prototypes"}, kShapes = {&World::scene, "shapes"},
               kMaterials = {&World::scene, "materials"};

/// The entries of a list or a map without those in [begin, end).
Json without_entries(const Json& entries, std::size_t begin, std::size_t end) {
  Json rest = entries.is_array() ? Json::array() : Json::object();
  std::size_t at = 0;
  for (auto entry = entries.begin(); entry != entries.end(); ++entry, ++at) {
    if (at >= begin && at < end) continue;
    if (entries.is_array()) {
      rest.push_back(entry.value());
    } else {
      rest[entry.key()] = entry.value();
    }
  }
  return rest;
}

/// Removes the followers of joints that were left out.
void let_followers_go(Json& joints) {
  std::set<std::string> names;
  for (const Json& joint : joints) names.insert(joint["name"].get<std::string>());
  for (Json& joint : joints) {
    for (const char* kind : {"hinge", "slider"}) {
      if (!joint.contains(kind) || !joint[kind].contains("follows")) continue;
      if (!names.contains(joint[kind]["follows"]["joint"].get<std::string>())) joint[kind].erase("follows");
    }
  }
}

void drop_joints_without_bodies(World& world) {
  std::set<std::string> names;
  for (const Json& body : world.scene["bodies"]) names.insert(body["name"].get<std::string>());
  Json& joints = world.scene["joints"];
  Json rest = Json::array();
  for (const Json& joint : joints) {
    if (std::ranges::all_of(joint["bodies"], [&](const Json& name) { return names.contains(name); })) {
      rest.push_back(joint);
    }
  }
  joints = std::move(rest);
  let_followers_go(joints);
}

/// Removes setpoints of joints or statics that were left out. `list`: list of setpoints; `key`: key with the name.
void drop_words_without(const char* list, const char* key, World& world) {
  if (!world.interference.contains("programs")) return;
  std::set<std::string> names;
  for (const Json& one : world.scene[list]) names.insert(one.value("name", ""));
  for (Json& word : world.interference["programs"]) {
    Json rest = Json::array();
    for (const Json& setpoint : word.value(list, Json::array())) {
      if (names.contains(setpoint[key].get<std::string>())) rest.push_back(setpoint);
    }
    word[list] = std::move(rest);
  }
}

/// Leaves out parts of the world step by step, as long as the world still fails.
class Shrinker {
 public:
  Shrinker(const World& world, const WorldOutcome& failure, const TrialRules& rules, std::uint64_t seed,
           double budget_s, const std::filesystem::path& directory, const std::atomic<bool>& stop)
      : failure_(failure), rules_(rules), seed_(seed), directory_(directory), stop_(stop) {
    end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(budget_s));
    best_.world = world;
    best_.outcome = failure;
    best_.steps = rules.steps;
    cut_off_the_rest();
  }

  bool time_is_up() const { return stop_ || Clock::now() >= end_; }

  /// Tries a world. True if it still fails in the same way; then it is the best world so far.
  bool accept(World world) {
    if (time_is_up()) return false;
    ++best_.trials;
    write_world(world, directory_);
    TrialRules rules = rules_;
    rules.steps = best_.steps;
    std::optional<WorldOutcome> outcome;
    try {
      outcome = run_world(directory_, rules, seed_, stop_);
    } catch (const std::exception&) {
      return false;  // invalid world: something refers to a part that was left out
    }
    if (!outcome || !fails_like(*outcome, failure_)) return false;
    best_.world = std::move(world);
    best_.outcome = *outcome;
    cut_off_the_rest();
    return true;
  }

  /// Leaves out chunks of a half, a quarter and so on, down to single entries.
  bool thin_out(const Part& part) {
    bool any = false;
    for (std::size_t chunk = part.size_in(best_.world); chunk > 0; chunk /= 2) {
      for (std::size_t begin = 0; begin < part.size_in(best_.world) && !time_is_up();) {
        World smaller = best_.world;
        Json& entries = *part.in(smaller);
        entries = without_entries(entries, begin, begin + chunk);
        drop_joints_without_bodies(smaller);
        drop_words_without("joints", "joint", smaller);
        drop_words_without("statics", "static", smaller);
        if (accept(std::move(smaller))) {
          any = true;
        } else {
          begin += chunk;
        }
      }
    }
    return any;
  }

  const Shrunk& best() const { return best_; }

 private:
  void cut_off_the_rest() {
    if (best_.outcome.first_difference && best_.outcome.error.empty()) best_.steps = *best_.outcome.first_difference;
  }

  const WorldOutcome& failure_;
  const TrialRules& rules_;
  std::uint64_t seed_;
  const std::filesystem::path& directory_;
  const std::atomic<bool>& stop_;
  Clock::time_point end_;
  Shrunk best_;
};

/// Makes settings plain, one at a time, in this order. The remaining ones show what the failure needs.
void make_plain(Shrinker& shrinker) {
  const auto try_world = [&](auto&& change) {
    World plainer = shrinker.best().world;
    change(plainer);
    shrinker.accept(std::move(plainer));
  };
  for (const char* key : {"solver", "iterations", "friction_directions", "erp", "continuous", "block"}) {
    if (shrinker.best().world.launch["physics"].contains(key)) {
      try_world([&](World& world) { world.launch["physics"].erase(key); });
    }
  }
  for (const char* key : {"lookahead", "substeps"}) {
    for (const int fewer : {1, 2}) {
      if (shrinker.best().world.launch["time"][key] > fewer) {
        try_world([&](World& world) { world.launch["time"][key] = fewer; });
      }
    }
  }
  for (const char* key :
       {"rolling_friction", "spinning_friction", "linear_damping", "angular_damping", "restitution"}) {
    try_world([&](World& world) {
      for (Json& material : world.scene["materials"]) material.erase(key);
    });
  }
  try_world([](World& world) {
    for (Json& body : world.scene["bodies"]) body.erase("spin");
  });
}

}  // namespace

Shrunk shrink(const World& world, const WorldOutcome& failure, const TrialRules& rules, std::uint64_t seed,
              double budget_s, const std::filesystem::path& directory, const std::atomic<bool>& stop) {
  constexpr std::array kParts = {kOrders, kPrograms, kInjectors, kBodies, kJoints, kStatics};
  Shrinker shrinker(world, failure, rules, seed, budget_s, directory, stop);
  for (bool again = true; again && !shrinker.time_is_up();) {
    again = false;
    for (const Part& part : kParts) again |= shrinker.thin_out(part);
  }
  make_plain(shrinker);
  for (const Part& part : {kPrototypes, kShapes, kMaterials}) shrinker.thin_out(part);
  return shrinker.best();
}

}  // namespace aurasim::lab
