#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "command_line/exit_code.h"
#include "config/key_page.h"
#include "config/key_schema.h"
#include "steering/ask_page.h"
#include "topics/topics.h"

namespace aurasim::cli {
namespace {

struct SchemaArguments {
  std::string section;
  bool markdown = false;
  bool asks = false;
  std::string json;
};

int print_keys(const SchemaArguments& arguments) {
  std::string text;
  if (arguments.asks) {
    text = steering::asks_as_markdown();
  } else if (arguments.json == "asks") {
    text = steering::ask_schema();
  } else if (arguments.json == "topics") {
    text = topics::as_json();
  } else if (arguments.markdown) {
    text = config::keys_as_markdown();
  } else if (!arguments.json.empty()) {
    text = config::key_schema(arguments.json == "launch" ? config::launch_file_keys() : config::scene_file_keys());
  } else {
    text = config::keys_as_text(arguments.section);
  }
  std::fputs(text.c_str(), stdout);
  if (!text.empty()) return 0;
  std::fprintf(stderr, "no section has \"%s\" in its title; all of them: aurasim schema\n", arguments.section.c_str());
  return static_cast<int>(command_line::ExitCode::kBadConfig);
}

}  // namespace

void add_schema(CLI::App& program, command_line::Action& action) {
  CLI::App* command =
      program.add_subcommand("schema", "every key of launch and scene files: unit, range, default, meaning");
  const auto arguments = std::make_shared<SchemaArguments>();
  command->add_option("SECTION", arguments->section, "only sections with this in their title, e.g. time, injector");
  auto* markdown = command->add_flag("--markdown", arguments->markdown, "as docs/keys.md has them");
  auto* asks = command->add_flag("--asks", arguments->asks, "what a run can be asked, as docs/commands.md has it")
                   ->excludes(markdown);
  command
      ->add_option("--json", arguments->json,
                   "as a JSON schema: of launch files, of scene files, or of asks; or the table of topics")
      ->check(CLI::IsMember({"launch", "scene", "asks", "topics"}))
      ->excludes(markdown)
      ->excludes(asks);
  command->footer("Example:\n  aurasim schema injector");
  command->callback([arguments, &action] { action = [arguments] { return print_keys(*arguments); }; });
}

}  // namespace aurasim::cli
