// What the laboratory's program says of itself: to people who mistype, to shells, to man.
#include "lab/commands/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line/completion.h"
#include "command_line/manual.h"

namespace aurasim::lab::commands {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class LabProgram : public ::testing::Test {
 protected:
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

TEST_F(LabProgram, HasEveryExperiment) {
  std::vector<std::string> names;
  for (const CLI::App* command : command_line::commands_of(*program_->get_subcommand("experiment"))) {
    names.push_back(command->get_name());
  }
  EXPECT_THAT(names, ::testing::ElementsAre("scenes", "endurance", "speed", "speed-errors"));
}

TEST_F(LabProgram, AnUnknownExperimentIsAnsweredWithTheNearest) {
  EXPECT_THAT(command_line::unknown_word(*program_, {"experiment", "sceens"}).value_or(""),
              AllOf(HasSubstr("aurasim-lab experiment: "), HasSubstr("did you mean 'scenes'?")));
}

TEST_F(LabProgram, EveryCommandHasAnExampleAndSaysWhatItIs) {
  for_each(*program_, [](const CLI::App& command) {
    EXPECT_THAT(command.get_footer(), HasSubstr("aurasim-lab ")) << command.get_name();
    EXPECT_THAT(command.get_description(), Not(IsEmpty())) << command.get_name();
  });
}

TEST_F(LabProgram, CompletionsAndManualAreItsOwn) {
  EXPECT_THAT(command_line::bash_completion(*program_),
              AllOf(HasSubstr("'aurasim-lab experiment scenes --sync') words='free_running bounded deterministic'"),
                    HasSubstr("complete -o default -F _aurasim_lab aurasim-lab\n")));
  EXPECT_THAT(command_line::zsh_completion(*program_), HasSubstr("#compdef aurasim-lab\n"));
  EXPECT_THAT(
      command_line::manual_page(*program_, "About it."),
      AllOf(HasSubstr(".TH AURASIM\\-LAB 1\n"), HasSubstr("aurasim\\-lab experiment scenes"), HasSubstr("About it.")));
}

}  // namespace
}  // namespace aurasim::lab::commands
