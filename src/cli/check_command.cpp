#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "config/launch.h"
#include "config/shipped_files.h"
#include "core/seam_tree.h"
#include "host/long_work.h"
#include "overseer/web_setup.h"
#include "process/exchange_choice.h"
#include "setup/launch_setup.h"
#include "setup/scene_warnings.h"

namespace aurasim::cli {
namespace {

std::string who_listens_when_coupled(std::size_t regions) {
  return core::SeamTree(regions).is_needed() ? "each listens to those near it, and along a tree"
                                             : "all listen to each other";
}

}  // namespace

void add_check(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("check", "validate a launch file and its scene");
  const auto files = std::make_shared<command_line::FileArguments>();
  files->add_to(*command);
  command->footer("Example:\n  aurasim check demo --set regions.count=9");
  command->callback([files, &action] {
    action = [files] {
      const config::Launch launch = config::read_launch(files->file, files->overrides);
      overseer::check_tls_of(launch);
      fmt::print("{}: scene '{}', {} bodies and {} injectors, {} regions, lookahead {}, {}\n", files->file,
                 launch.scene.name, launch.scene.bodies.size(), launch.scene.injectors.size(), launch.regions.size(),
                 launch.lookahead(),
                 launch.is_coupled() ? who_listens_when_coupled(launch.regions.size())
                                     : fmt::format("listening distance {:.2f} m", setup::listening_distance_m(launch)));
      if (launch.regions.size() > 1 && launch.exchange != config::Exchange::kAura) {
        fmt::print(
            "exchange: {}\n",
            launch.exchange == config::Exchange::kAuto
                ? fmt::format("auto: coupled if round trips take at most {:.3g} ms when the nodes meet, else aura",
                              1e3 * launch.exchange_limit_s())
                : std::string("coupled"));
        if (const std::string moved = process::words_of_moved_borders(launch); !moved.empty())
          fmt::print("{}\n", moved);
      } else if (launch.regions.size() > 1 && !launch.why_exchange.empty()) {
        fmt::print("exchange: auto means aura: {}\n", launch.why_exchange);
      }
      std::fflush(stdout);
      host::LongWork work("looking for bodies that overlap",
                          [](const std::string& text) { fmt::print(stderr, "{}\n", text); });
      for (const std::string& text : setup::scene_warnings(launch, [&work](double share) { work.reached(share); })) {
        fmt::print(stderr, "warning: {}\n", text);
      }
      return 0;
    };
  });
}

}  // namespace aurasim::cli
