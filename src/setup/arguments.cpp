#include "setup/arguments.h"

namespace aurasim::setup {

void LauncherArguments::add_to(CLI::App& command) {
  command.add_flag("--has-launcher", is_there, "whoever has started this process starts another one when a node dies")
      ->group("");
  command.add_option("--heartbeat", heartbeat, "number of the pipe that it reads signs of life from")->group("");
}

void KeyArguments::add_to(CLI::App& command) {
  command.add_option("--as", as, "in a run with keys, join it as this name of dds.security")->type_name("NAME");
}

CLI::Option* add_to(CLI::App& command, cut::LoadArguments& arguments) {
  CLI::Option* load = command.add_option("--load", arguments.file, "a saved world to go on from (aurasim send save)");
  command.add_flag("--other-build", arguments.other_build, "also load a world that another build has saved");
  return load;
}

void add_to(CLI::App& command, cut::SaveArguments& arguments) {
  command.add_option("--saves", arguments.folder, "folder for the nodes' parts of saved worlds")
      ->each([&arguments](const std::string&) { arguments.folder_is_given = true; });
  command
      .add_option("--save-every", arguments.every_s,
                  "save the world so often, in simulated seconds. 0: only when asked to")
      ->check(CLI::Range(0.0, 1e9));
  command.add_option("--save-keep", arguments.keep, "with --save-every: so many of them stay, the newest")
      ->check(CLI::Range(1, 1'000'000));
}

}  // namespace aurasim::setup
