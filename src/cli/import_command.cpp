#include <memory>

#include "cli/commands.h"
#include "cli/import_arguments.h"
#include "host/spawn.h"
#include "setup/launch_setup.h"

namespace aurasim::cli {
namespace {

/// Runs aurasim-import in place of this process, with the same command line. Throws if there is none.
int become_importer() {
  std::vector<std::string> words = host::own_command_line();
  words.at(0) =
      setup::program_beside("aurasim-import",
                            "The package of that name has it; from the sources, `scripts/setup.sh && scripts/build.sh "
                            "release aurasim-import` builds it")
          .string();
  host::become(std::move(words));
}

}  // namespace

CLI::App* add_import_words(CLI::App& program, ImportArguments& given) {
  CLI::App* command = program.add_subcommand("import", "make a scene file of a URDF, SDF, MJCF or mesh file");
  command->add_option("FILE", given.file, "URDF, SDF, MJCF (told by what is in it), OBJ, STL, glTF or DAE")->required();
  command->add_option("--out", given.out, "the scene file to write; without it, it is printed");
  command->add_option("--as", given.names, "a copy of the model, whose names all begin with NAME/")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--at", given.poses, "where the copy stands: x,y,z in metres, then roll,pitch,yaw in degrees")
      ->type_name("X,Y,Z[,R,P,Y]")
      ->allow_extra_args(false);
  command->add_option("--path", given.paths, "another folder in which meshes and included models may lie")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
  command->add_option("--mass", given.mass_kg, "kg: makes a mesh file a body that moves; without it, it is a static")
      ->check(CLI::PositiveNumber)
      ->default_str("");
  command->add_flag("--strict", given.strict, "write nothing, and end with code 2, if a scene cannot say all of it");
  command->footer(
      "Example:\n  aurasim import robot.urdf --out robots.yaml --as left --at 0,-1,0 --as right --at 0,1,0,0,0,90");
  return command;
}

CLI::App* add_export_words(CLI::App& program, ExportArguments& given) {
  CLI::App* command = program.add_subcommand("export", "make an SDF file of a launch file's scene");
  given.files.add_to(*command);
  command->add_option("--out", given.out, "the SDF file to write; without it, it is printed");
  command->add_flag("--strict", given.strict, "write nothing, and end with code 2, if SDF cannot say all of it");
  command->footer("Example:\n  aurasim export newtons_cradle --out cradle.sdf");
  return command;
}

void add_import(CLI::App& program, command_line::Action& action) {
  const auto given = std::make_shared<ImportArguments>();
  add_import_words(program, *given)->callback([given, &action] { action = become_importer; });
}

void add_export(CLI::App& program, command_line::Action& action) {
  const auto given = std::make_shared<ExportArguments>();
  add_export_words(program, *given)->callback([given, &action] { action = become_importer; });
}

}  // namespace aurasim::cli
