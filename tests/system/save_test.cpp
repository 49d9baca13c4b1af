// Saved worlds of real runs: `aurasim send save`, `launch --load`, `cut info`, `cut merge`.
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using Hashes = std::map<std::int64_t, std::string>;

class SavedWorlds : public SystemTest {
 protected:
  static constexpr std::int64_t kSteps = 600;

  Words overrides_of(const std::string& regions) const {
    Words all = {"time.sync=deterministic"};
    if (!regions.empty()) all.push_back("regions=" + regions);
    return set(all);
  }

  /// A run of the demo whose world is saved under way. Its parts go into `saves`.
  nlohmann::json run_and_save(const std::string& name, const Words& more = {}) {
    Process& run = launch(name, launch_file("demo"),
                          Words{"--steps", std::to_string(kSteps), "--saves", saves()} + overrides_of("") + more);
    expect_reaches(report_of(name), 4, 150);
    Process& save = start(Words{"send", "save", launch_file("demo"), "world.cut"} + overrides_of("") + in_own_domain());
    expect_exit(save, 0);
    const nlohmann::json said = nlohmann::json::parse(save.out(), nullptr, false);
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of(name));
    return said;
  }

  /// The hashes of a run that goes on from it.
  Hashes load(const std::string& name, const std::string& regions, const std::string& saved) {
    Process& run = launch(
        name, launch_file("demo"),
        Words{"--steps", std::to_string(kSteps), "--load", saved} + overrides_of(regions) + set({"time.pace=none"}));
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of(name));
    return hashes(name);
  }

  Hashes hashes(const std::string& name) const {
    Hashes all;
    std::istringstream rows(report_of(name).state_hash());
    for (std::string line; std::getline(rows, line);) {
      const std::size_t comma = line.find(',');
      if (comma != std::string::npos && line != "step,hash") all[std::stoll(line)] = line.substr(comma + 1);
    }
    return all;
  }

  /// Of which there are files that nobody has asked for.
  std::set<std::int64_t> saved_states() const {
    std::set<std::int64_t> states;
    for (const auto& entry : std::filesystem::directory_iterator(saves())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("state-")) states.insert(std::stoll(name.substr(6)));
    }
    return states;
  }

  std::string refusal_of(const Words& words) {
    Process& run = start(words);
    expect_exit(run, 2);
    return run.err();
  }

  std::string saves() const { return (folder() / "saves").string(); }
  /// Where "world.cut" is.
  std::string file() const { return saves() + "/world.cut"; }
};

TEST_F(SavedWorlds, GoOnWithTheSameBitsOnAnyNumberOfNodes) {
  const nlohmann::json said = run_and_save("never_stopped");
  ASSERT_EQ(said.value("file", ""), file());
  const auto step = said.value("step", std::int64_t{0});
  ASSERT_GT(step, 150);
  Hashes wanted = hashes("never_stopped");
  wanted.erase(wanted.begin(), wanted.find(step));
  ASSERT_EQ(wanted.size(), static_cast<std::size_t>(kSteps - step + 1));
  for (const auto& [name, regions] :
       std::map<std::string, std::string>{{"one", "{layout: columns, count: 1, width: 40}"},
                                          {"two", "{layout: columns, count: 2, width: 20}"},
                                          {"four", ""},
                                          {"nine", "{layout: grid, rows: 3, columns: 3, cell: [12, 12]}"}}) {
    EXPECT_EQ(load(name, regions, file()), wanted) << name;
  }
  Process& compare =
      start({"compare", report_of("never_stopped").folder().string(), report_of("two").folder().string()});
  expect_exit(compare, 0);
  EXPECT_THAT(compare.out(), ::testing::HasSubstr("from state " + std::to_string(step)));
}

TEST_F(SavedWorlds, ThatNobodyAskedForAreLoadedFromTheirParts) {
  Process& run = launch("run", launch_file("demo"),
                        Words{"--steps", std::to_string(kSteps), "--saves", saves(), "--save-every", "2"} +
                            overrides_of("") + set({"time.pace=none"}));
  expect_exit(run, 0);
  const std::set<std::int64_t> states = saved_states();
  // A node that has ended before it knew that the last one is whole has not removed the oldest.
  ASSERT_TRUE(states.size() == 3 || states.size() == 4) << "the newest three: " << ::testing::PrintToString(states);
  const std::int64_t step = *states.rbegin();
  Hashes wanted = hashes("run");
  wanted.erase(wanted.begin(), wanted.find(step));
  const std::string world = saves() + "/state-" + std::to_string(step) + ".cut";
  EXPECT_EQ(load("again", "{layout: columns, count: 2, width: 20}", world), wanted);

  Words merge = {"cut", "merge", file()};
  for (const auto& entry : std::filesystem::directory_iterator(saves())) {
    if (entry.path().string().starts_with(world + ".")) merge.push_back(entry.path().string());
  }
  ASSERT_EQ(merge.size(), 3U + 4U);
  expect_exit(start(merge), 0);
  Process& info = start({"cut", "info", file()});
  expect_exit(info, 0);
  const nlohmann::json told = nlohmann::json::parse(info.out());
  EXPECT_EQ(told.value("step", 0), step);
  EXPECT_EQ(told.value("parts", 0), 1);
  EXPECT_GT(told.value("bodies", 0), 100);
  merge.pop_back();
  EXPECT_THAT(refusal_of(merge), ::testing::HasSubstr("3 of 4 parts"));
}

TEST_F(SavedWorlds, ARunGoesBackToOneWithoutEnding) {
  Process& whole = launch("never_stopped", launch_file("demo"),
                          Words{"--steps", "400"} + overrides_of("") + set({"time.pace=none"}));
  expect_exit(whole, 0);
  Process& run = launch("run", launch_file("demo"),
                        Words{"--steps", "400", "--saves", saves(), "--save-every", "1"} + overrides_of(""));
  expect_reaches(report_of("run"), 4, 180);
  const std::set<std::int64_t> states = saved_states();
  ASSERT_GE(states.size(), 2U);
  const std::int64_t step = *std::prev(states.end(), 2);  // the newest may not be whole yet
  const std::string world = "state-" + std::to_string(step) + ".cut";
  const Words at = overrides_of("") + in_own_domain();
  expect_exit(start(Words{"send", "load", launch_file("demo"), world} + at), 0);
  Process& none = start(Words{"send", "load", launch_file("demo"), "nothing.cut"} + at);
  expect_exit(none, 1);
  EXPECT_THAT(none.err(), ::testing::HasSubstr("no such file"));
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  Hashes wanted = hashes("never_stopped");
  wanted.erase(wanted.begin(), wanted.find(step));
  EXPECT_EQ(hashes("run"), wanted);
}

TEST_F(SavedWorlds, OfAPausedRunAreTheStateInWhichItStands) {
  Process& run =
      launch("run", launch_file("demo"),
             Words{"--steps", "300", "--saves", saves()} + overrides_of("") + set({"survival.on_death=stop"}));
  expect_reaches(report_of("run"), 4, 100);
  const Words at = overrides_of("") + set({"survival.on_death=stop"}) + in_own_domain();
  expect_exit(start(Words{"send", "pause", launch_file("demo")} + at), 0);
  Process& save = start(Words{"send", "save", launch_file("demo"), "world.cut"} + at);
  expect_exit(save, 0);
  const nlohmann::json said = nlohmann::json::parse(save.out());
  const auto step = said.value("step", std::int64_t{0});
  Process& step_on = start(Words{"send", "step", launch_file("demo")} + at);
  expect_exit(step_on, 0);
  EXPECT_THAT(step_on.out(), ::testing::HasSubstr("done at step " + std::to_string(step + 1)));
  expect_exit(start(Words{"send", "resume", launch_file("demo")} + at), 0);
  expect_exit(run, 0);
  Hashes wanted = hashes("run");
  wanted.erase(wanted.begin(), wanted.find(step));
  Process& again =
      launch("again", launch_file("demo"),
             Words{"--steps", "300", "--load", file()} + overrides_of("{layout: columns, count: 2, width: 20}") +
                 set({"time.pace=none", "survival.on_death=stop"}));
  expect_exit(again, 0);
  EXPECT_EQ(hashes("again"), wanted);
}

/// All compute as far as it takes for the change, and stand again in its first state.
TEST_F(SavedWorlds, AreLoadedInAPauseToo) {
  Process& run = launch("run", launch_file("demo"),
                        Words{"--steps", "300", "--saves", saves(), "--save-every", "1"} + overrides_of(""));
  expect_reaches(report_of("run"), 4, 170);
  const Words at = overrides_of("") + in_own_domain();
  expect_exit(start(Words{"send", "pause", launch_file("demo")} + at), 0);
  const std::int64_t step = *saved_states().begin();
  const std::string world = "state-" + std::to_string(step) + ".cut";
  expect_exit(start(Words{"send", "load", launch_file("demo"), world} + at), 0);
  Process& top = start(Words{"top", launch_file("demo"), "--duration", "1"} + at);
  expect_exit(top, 0);
  EXPECT_THAT(top.out(), ::testing::HasSubstr("paused"));
  expect_exit(start(Words{"send", "resume", launch_file("demo")} + at), 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_EQ(hashes("run").begin()->first, step);
}

/// From memory: nothing has been saved.
TEST_F(SavedWorlds, NobodyNeedsOneToStepBackInTime) {
  Process& whole = launch("never_stopped", launch_file("demo"),
                          Words{"--steps", "400"} + overrides_of("") + set({"regions.count=1", "time.pace=none"}));
  expect_exit(whole, 0);
  Process& run = launch("run", launch_file("demo"),
                        Words{"--steps", "400", "--saves", saves()} + overrides_of("") + set({"survival.disk=off"}));
  expect_reaches(report_of("run"), 4, 270);
  const Words at = overrides_of("") + in_own_domain();
  expect_exit(start(Words{"send", "pause", launch_file("demo")} + at), 0);
  std::int64_t before = 1000;
  for (int i = 0; i < 2; ++i) {
    Process& back = start(Words{"send", "back", launch_file("demo")} + at);
    expect_exit(back, 0);
    const auto step = nlohmann::json::parse(back.out(), nullptr, false).value("step", std::int64_t{-1});
    EXPECT_GT(step, 0);
    EXPECT_LT(step, before);
    before = step;
  }
  EXPECT_TRUE(std::filesystem::is_empty(saves()));
  expect_exit(start(Words{"send", "resume", launch_file("demo")} + at), 0);
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_EQ(hashes("run"), hashes("never_stopped"));
}

/// The body collides as it did, and who looks on gets the mesh, though nobody who brought it is there.
TEST_F(SavedWorlds, HoldTheMeshesOfClients) {
  Process& run = launch("run", launch_file("demo"),
                        Words{"--steps", std::to_string(kSteps), "--saves", saves()} + overrides_of(""));
  expect_reaches(report_of("run"), 4, 1);
  const Words at = overrides_of("") + in_own_domain();
  Process& spawn = start(Words{"send", "spawn", launch_file("demo"), "--p", "1", "1", "6", "--mesh",
                               AURASIM_SOURCE_DIR "/tests/config/meshes/wedge.obj"} +
                         at);
  expect_exit(spawn, 0);
  const auto born = nlohmann::json::parse(spawn.out()).value("step", std::int64_t{0});
  Process& late = start(Words{"echo", "shape", launch_file("demo"), "--count", "1", "--duration", "20", "--json"} + at);
  expect_exit(late, 0);
  const nlohmann::json mesh = nlohmann::json::parse(late.out());
  expect_reaches(report_of("run"), 4, born + 30);
  expect_exit(start(Words{"send", "save", launch_file("demo"), "world.cut"} + at), 0);
  expect_exit(run, 0);
  Process& again = launch("again", launch_file("demo"),
                          Words{"--steps", std::to_string(kSteps), "--load", file()} +
                              overrides_of("{layout: columns, count: 2, width: 20}"));
  const Words at_again = overrides_of("{layout: columns, count: 2, width: 20}") + in_own_domain();
  Process& told =
      start(Words{"echo", "shape", launch_file("demo"), "--count", "1", "--duration", "20", "--json"} + at_again);
  expect_exit(told, 0);
  EXPECT_EQ(nlohmann::json::parse(told.out()).at("hash"), mesh.at("hash"));
  EXPECT_EQ(nlohmann::json::parse(told.out()).at("points"), mesh.at("points"));
  expect_exit(again, 0);
  const Hashes found = hashes("again");
  Hashes wanted = hashes("run");
  wanted.erase(wanted.begin(), wanted.find(found.begin()->first));
  EXPECT_EQ(found, wanted);
}

TEST_F(SavedWorlds, OfAnotherWorldAreRefusedBeforeAnythingIsStarted) {
  run_and_save("run");
  const auto load_by = [&](const std::string& scene, const Words& overrides) {
    return refusal_of(Words{"launch", launch_file(scene), "--headless", "--load", file()} + set(overrides) +
                      in_own_domain());
  };
  EXPECT_THAT(load_by("tower", {}), ::testing::HasSubstr("scene corner_stacks"));
  EXPECT_THAT(load_by("demo", {"physics.preset=fast"}), ::testing::HasSubstr("8 substeps"));
  std::string bytes = read_text(file());
  bytes.resize(bytes.size() / 2);
  write("saves/world.cut", bytes);
  EXPECT_THAT(load_by("demo", {}), ::testing::HasSubstr("cut short"));
  std::filesystem::remove(file());
  EXPECT_THAT(load_by("demo", {}), ::testing::HasSubstr("no such file"));
}

TEST_F(SavedWorlds, AreCalledByNothingThatLeadsElsewhere) {
  Process& run = launch("run", launch_file("demo"), Words{"--saves", saves()} + overrides_of(""));
  expect_reaches(report_of("run"), 4, 1);
  Process& hidden = start(Words{"send", "save", launch_file("demo"), ".hidden"} + overrides_of("") + in_own_domain());
  expect_exit(hidden, 2);
  EXPECT_THAT(hidden.err(), ::testing::HasSubstr("does not begin with"));
  for (const char* what : {"save", "load"}) {
    const std::string elsewhere = (folder() / "world.cut").string();
    Process& sent = start(Words{"send", what, launch_file("demo"), elsewhere} + overrides_of("") + in_own_domain());
    expect_exit(sent, 2);
    EXPECT_THAT(sent.err(), ::testing::HasSubstr("a saved world's name has letters"));
    EXPECT_THAT(sent.err(), ::testing::HasSubstr(elsewhere));
  }
  run.signal(SIGTERM);
  expect_exit(run, 0);
}

TEST_F(SavedWorlds, ADiskThatFailsIsNamedAndTheRunGoesOn) {
  const Words off = set({"survival.disk=off"});
  Process& run =
      launch("run", launch_file("demo"), Words{"--steps", "400", "--saves", saves()} + overrides_of("") + off);
  expect_reaches(report_of("run"), 4, 1);
  std::filesystem::remove_all(saves());
  write("saves", "a file in its place");
  Process& save = start(Words{"send", "save", launch_file("demo"), "world.cut"} + overrides_of("") + in_own_domain());
  expect_exit(save, 1);
  EXPECT_THAT(save.err(), ::testing::HasSubstr(saves()));
  expect_exit(run, 0);
}

}  // namespace
}  // namespace aurasim::system_test
