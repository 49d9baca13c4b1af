#include <cstdio>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/exit_code.h"
#include "config/key_page.h"
#include "config/key_schema.h"

namespace aurasim::cli {
namespace {

struct KeysArguments {
  std::string section;
  bool markdown = false;
  std::string schema;
};

int print_keys(const KeysArguments& arguments) {
  std::string text;
  if (arguments.markdown) {
    text = config::keys_as_markdown();
  } else if (!arguments.schema.empty()) {
    text = config::key_schema(arguments.schema == "launch" ? config::launch_file_keys() : config::scene_file_keys());
  } else {
    text = config::keys_as_text(arguments.section);
  }
  std::fputs(text.c_str(), stdout);
  if (!text.empty()) return 0;
  std::fprintf(stderr, "no section has \"%s\" in its title; all of them: aurasim keys\n", arguments.section.c_str());
  return static_cast<int>(ExitCode::kBadConfig);
}

}  // namespace

void add_keys(CLI::App& program, Action& action) {
  CLI::App* command =
      program.add_subcommand("keys", "every key of launch and scene files: unit, range, default, meaning");
  const auto arguments = std::make_shared<KeysArguments>();
  command->add_option("SECTION", arguments->section, "only sections with this in their title, e.g. time, injector");
  auto* markdown = command->add_flag("--markdown", arguments->markdown, "as docs/scenes.md has them");
  command->add_option("--schema", arguments->schema, "as a JSON schema for editors: of launch files, or of scene files")
      ->check(CLI::IsMember({"launch", "scene"}))
      ->excludes(markdown);
  command->footer("Example:\n  aurasim keys injector");
  command->callback([arguments, &action] { action = [arguments] { return print_keys(*arguments); }; });
}

}  // namespace aurasim::cli
