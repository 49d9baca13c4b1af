#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "command_line/exit_code.h"
#include "cut/part_store.h"

namespace aurasim::cli {
namespace {

struct CutArguments {
  std::string file;
  std::vector<std::string> parts;
};

/// A file that cannot be used is a wrong argument.
template <class Work>
int refusing_bad_files(Work&& work) {
  try {
    work();
    return static_cast<int>(command_line::ExitCode::kOk);
  } catch (const cut::BadCut& bad) {
    fmt::print(stderr, "{}\n", bad.what());
    return static_cast<int>(command_line::ExitCode::kBadConfig);
  }
}

void print_info(const cut::SavedWorld& world) {
  std::size_t bodies_under_way = 0, points = world.cut.bodies.points.size();
  for (const core::UnderWay& one : world.cut.under_way) {
    bodies_under_way += one.cluster.bodies.size();
    points += one.cluster.points.size();
  }
  const cut::Identity& id = world.identity;
  const nlohmann::ordered_json info = {{"step", world.cut.step},
                                       {"launch", id.launch},
                                       {"scene", id.scene},
                                       {"physics", id.physics},
                                       {"program", id.program},
                                       {"world", fmt::format("{:016x}", id.world)},
                                       {"part", world.part},
                                       {"parts", world.parts},
                                       {"bodies", core::body_count(world.cut)},
                                       {"bodies_under_way", bodies_under_way},
                                       {"contact_points", points / core::kContactPointDoubles},
                                       {"orders", world.cut.orders.size()}};
  fmt::print("{}\n", info.dump(2));
}

int show_info(const CutArguments& arguments) {
  return refusing_bad_files([&] {
    const std::filesystem::path file = arguments.file;
    print_info(std::filesystem::exists(file) ? cut::read_cut(file) : cut::read_world(file));
  });
}

int merge(const CutArguments& arguments) {
  return refusing_bad_files([&] {
    const std::vector<std::filesystem::path> parts(arguments.parts.begin(), arguments.parts.end());
    cut::write_cut(arguments.file, cut::merge_cuts(parts));
  });
}

}  // namespace

void add_cut(CLI::App& program, command_line::Action& action) {
  CLI::App* cut_app = program.add_subcommand("cut", "look at saved worlds, and put their parts together");
  cut_app->require_subcommand(1);
  cut_app->footer("Example:\n  aurasim cut info world.cut");
  const auto arguments = std::make_shared<CutArguments>();

  CLI::App* info = cut_app->add_subcommand("info", "what is in a saved world");
  info->add_option("FILE", arguments->file, "that send save has written, or a part of it")->required();
  info->footer("Example:\n  aurasim cut info world.cut");
  info->callback([arguments, &action] { action = [arguments] { return show_info(*arguments); }; });

  CLI::App* together = cut_app->add_subcommand("merge", "one file of the parts of all nodes");
  together->add_option("FILE", arguments->file, "to be written")->required();
  together->add_option("PARTS", arguments->parts, "of all nodes")->required()->check(CLI::ExistingFile);
  together->footer("Example:\n  aurasim cut merge world.cut saves/world.cut.*");
  together->callback([arguments, &action] { action = [arguments] { return merge(*arguments); }; });
}

}  // namespace aurasim::cli
