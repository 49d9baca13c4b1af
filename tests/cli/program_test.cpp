// What the program says of itself: to people who mistype, to shells, to man.
#include "cli/program.h"

#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line/completion.h"
#include "command_line/manual.h"
#include "command_line/nearest_word.h"
#include "host/version.h"

namespace aurasim::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Words = std::vector<std::string>;

class Program : public ::testing::Test {
 protected:
  std::string about(const Words& words) { return command_line::unknown_word(*program_, words).value_or(""); }

  template <class Visit>
  void for_each(const CLI::App& app, const Visit& visit) {
    for (const CLI::App* command : command_line::commands_of(app)) {
      visit(*command);
      for_each(*command, visit);
    }
  }

  command_line::Action action_;
  std::unique_ptr<CLI::App> program_ = make_program(action_);
};

TEST(NearestWord, CountsLettersAndSwaps) {
  EXPECT_EQ(command_line::typing_distance("launch", "launch"), 0U);
  EXPECT_EQ(command_line::typing_distance("lunch", "launch"), 1U);
  EXPECT_EQ(command_line::typing_distance("alunch", "launch"), 1U);
  EXPECT_EQ(command_line::typing_distance("", "top"), 3U);
  EXPECT_EQ(command_line::nearest_word("lanuch", {"check", "launch", "top"}), "launch");
  EXPECT_EQ(command_line::nearest_word("fly", {"check", "launch"}), std::nullopt);
}

TEST_F(Program, AnUnknownCommandIsAnsweredWithTheNearest) {
  EXPECT_THAT(about({"lunch", "demo"}), AllOf(HasSubstr("'lunch'"), HasSubstr("did you mean 'launch'?")));
  EXPECT_THAT(about({"send", "puase", "demo"}), HasSubstr("did you mean 'pause'?"));
  EXPECT_THAT(about({"fly"}), AllOf(HasSubstr("there are check, "), Not(HasSubstr("did you mean"))));
}

TEST_F(Program, AnUnknownOptionIsAnsweredWithTheNearest) {
  EXPECT_THAT(about({"launch", "demo", "--headles"}), HasSubstr("did you mean '--headless'?"));
  EXPECT_THAT(about({"launch", "demo", "--reprot=out"}), HasSubstr("did you mean '--report'?"));
  EXPECT_THAT(about({"--versoin"}), HasSubstr("did you mean '--version'?"));
}

TEST_F(Program, WhatIsKnownIsNotComplainedAbout) {
  for (const Words& words :
       {Words{"launch", "demo", "--steps", "-5"}, Words{"send", "spawn", "demo", "--p", "-1", "0", ".5"},
        Words{"check"}, Words{"compare", "a", "b", "--json"}, Words{"-h"}, Words{}}) {
    EXPECT_EQ(about(words), "");
  }
}

TEST_F(Program, ACommandThatAnotherProgramHasNowIsAnsweredWithThatProgram) {
  EXPECT_THAT(moved_command({"experiment", "scenes", "--seeds", "1-200"}).value_or(""),
              HasSubstr("now: aurasim-lab experiment scenes --seeds 1-200\n"));
  for (const Words& words : {Words{}, Words{"launch", "experiment"}, Words{"--version"}}) {
    EXPECT_EQ(moved_command(words), std::nullopt);
  }
}

TEST_F(Program, EveryCommandHasAnExampleAndSaysWhatItIs) {
  for_each(*program_, [](const CLI::App& command) {
    EXPECT_THAT(command.get_footer(), HasSubstr("aurasim ")) << command.get_name();
    EXPECT_THAT(command.get_description(), Not(IsEmpty())) << command.get_name();
  });
}

TEST_F(Program, HelpShowsDefaultsButNotThoseThatMeanNone) {
  const std::string help = program_->get_subcommand("launch")->help();
  EXPECT_THAT(help, HasSubstr("30")) << "--start-time-out";
  const std::string spawn = program_->get_subcommand("send")->get_subcommand("spawn")->help();
  EXPECT_THAT(spawn, Not(HasSubstr("[]")));
}

TEST_F(Program, CompletionsAndManualNameEveryCommandAndOption) {
  const std::string bash = command_line::bash_completion(*program_), zsh = command_line::zsh_completion(*program_),
                    man = command_line::manual_page(*program_, "");
  const std::string read_man = std::regex_replace(man, std::regex(R"(\\-)"), "-");  // as a reader sees it
  for_each(*program_, [&](const CLI::App& command) {
    for (const std::string& text : {bash, zsh, read_man}) EXPECT_THAT(text, HasSubstr(command.get_name()));
    for (const CLI::Option* option : command_line::options_of(command)) {
      if (option->get_positional() || command_line::name_of(*option) == "--help") continue;
      EXPECT_THAT(bash, HasSubstr(command_line::name_of(*option)));
      EXPECT_THAT(zsh, HasSubstr(command_line::name_of(*option)));
    }
  });
  EXPECT_THAT(bash,
              AllOf(HasSubstr("'aurasim completion') words="), HasSubstr("complete -o default -F _aurasim aurasim\n")));
  EXPECT_THAT(man, HasSubstr("\\fB\\-\\-start\\-time\\-out\\fR"));
}

TEST(Version, NamesCommitBuildAndCompiler) {
  EXPECT_THAT(host::version_text(), AllOf(HasSubstr("aurasim 0."), HasSubstr(host::commit()), HasSubstr("GCC 1")));
}

}  // namespace
}  // namespace aurasim::cli
