// The other side of overseer/mesh_process.h. Not for people: it is not in the help.
#include <cstdio>
#include <iostream>
#include <iterator>
#include <memory>

#include "cli/commands.h"
#include "config/convex_parts.h"
#include "config/meshes.h"
#include "overseer/mesh_process.h"

namespace aurasim::cli {
namespace {

std::string all_of_stdin() {
  std::cin >> std::noskipws;
  return {std::istreambuf_iterator<char>(std::cin), {}};
}

int tell(const overseer::MeshOrWhy& mesh) {
  const std::string bytes = overseer::mesh_bytes(mesh);
  std::fwrite(bytes.data(), 1, bytes.size(), stdout);
  std::fflush(stdout);
  return 0;
}

int take_apart() {
  const overseer::MeshOrWhy whole = overseer::mesh_of_bytes(all_of_stdin());
  if (std::holds_alternative<std::string>(whole)) return tell(whole);
  return tell(config::decompose(std::get<core::TriangleMesh>(whole)));
}

}  // namespace

void add_mesh_loader(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("mesh-loader", "read a mesh from standard input")->group("");
  command->require_subcommand(1);
  const auto name = std::make_shared<std::string>();
  CLI::App* read = command->add_subcommand("read", "the bytes of a mesh file");
  read->add_option("NAME", *name, "says the format by its ending")->required();
  read->callback([name, &action] { action = [name] { return tell(config::read_mesh(*name, all_of_stdin())); }; });
  CLI::App* parts = command->add_subcommand("parts", "take a mesh apart into convex parts");
  parts->callback([&action] { action = take_apart; });
}

}  // namespace aurasim::cli
