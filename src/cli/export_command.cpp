#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/text_files.h"
#include "config/launch.h"
#include "import/sdf_writer.h"
#include "overseer/convex_hull.h"

namespace aurasim::cli {
namespace {

struct ExportArguments {
  FileArguments files;
  std::string out;
  bool strict = false;
};

int run_export(const ExportArguments& given) {
  const config::Launch launch = config::read_launch(given.files.file, given.files.overrides);
  std::vector<std::string> names;
  for (const config::SceneSource& source : launch.body_sources) names.push_back(source.name);
  const std::string file = given.out.empty() ? launch.scene.name + ".sdf" : given.out;
  const import::SdfText world = import::sdf_text(launch.scene, names, file, overseer::hull_triangles);
  for (const import::Finding& finding : world.lost)
    fmt::print(stderr, "not representable: {}: {}\n", finding.element, finding.what);
  if (given.strict && !world.lost.empty()) return static_cast<int>(ExitCode::kBadConfig);
  write_texts(given.out, world.xml, world.meshes);
  return 0;
}

}  // namespace

void add_export(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("export", "make an SDF file of a launch file's scene");
  const auto given = std::make_shared<ExportArguments>();
  given->files.add_to(*command);
  command->add_option("--out", given->out, "the SDF file to write; without it, it is printed");
  command->add_flag("--strict", given->strict, "write nothing, and end with code 2, if SDF cannot say all of it");
  command->footer("Example:\n  aurasim export newtons_cradle --out cradle.sdf");
  command->callback([given, &action] { action = [given] { return run_export(*given); }; });
}

}  // namespace aurasim::cli
