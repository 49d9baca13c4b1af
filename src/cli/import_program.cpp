#include "cli/import_program.h"

#include <cmath>
#include <map>
#include <numbers>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/text_files.h"
#include "command_line/exit_code.h"
#include "config/launch.h"
#include "import/read_model.h"
#include "import/scene_writer.h"
#include "import/sdf_writer.h"
#include "physics/hull_triangles.h"

namespace aurasim::cli {
namespace {

constexpr std::size_t kMostNamesInANote = 3;

[[noreturn]] void refuse_pose(const std::string& text) {
  throw config::BadConfig(
      {fmt::format("--at {}: allowed: x,y,z in metres, or x,y,z,roll,pitch,yaw with degrees", text)});
}

/// "x,y,z" or "x,y,z,roll,pitch,yaw", as `position` and `rpy_deg` of a scene.
core::Pose pose_from(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    std::size_t used = 0;
    try {
      numbers.push_back(std::stod(text.substr(at, end - at), &used));
    } catch (const std::exception&) {
      refuse_pose(text);
    }
    if (used != end - at || !std::isfinite(numbers.back())) refuse_pose(text);
    at = end + 1;
  }
  if (numbers.size() != 3 && numbers.size() != 6) refuse_pose(text);
  core::Pose pose{{numbers[0], numbers[1], numbers[2]}, core::Quat::Identity()};
  if (numbers.size() == 6) {
    const auto about = [&](std::size_t i, const core::Vec3& axis) {
      return Eigen::AngleAxisd(numbers[i] * std::numbers::pi / 180, axis);
    };
    pose.q_WB = about(5, core::Vec3::UnitZ()) * about(4, core::Vec3::UnitY()) * about(3, core::Vec3::UnitX());
  }
  return pose;
}

std::vector<importing::Instance> instances_of(const ImportArguments& given) {
  if (given.names.empty() && given.poses.size() <= 1) {
    return {{"", given.poses.empty() ? core::Pose{} : pose_from(given.poses.front())}};
  }
  if (given.poses.size() > given.names.size() || (given.names.size() > 1 && given.poses.size() != given.names.size()))
    throw config::BadConfig({fmt::format("found {} --as and {} --at, allowed: one --at for each --as",
                                         given.names.size(), given.poses.size())});
  std::vector<importing::Instance> instances;
  for (std::size_t i = 0; i < given.names.size(); ++i) {
    for (const importing::Instance& other : instances) {
      if (other.prefix == given.names[i])
        throw config::BadConfig({fmt::format("--as {}: the name is there twice", given.names[i])});
    }
    instances.push_back({given.names[i], given.poses.empty() ? core::Pose{} : pose_from(given.poses[i])});
  }
  return instances;
}

/// Each thing that was left out once, with a few of the elements that have it.
void print_notes(const importing::Model& model) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<std::string>> elements;
  for (const importing::Finding& note : model.notes) {
    std::vector<std::string>& of_this = elements[note.what];
    if (of_this.empty()) order.push_back(note.what);
    of_this.push_back(note.element);
  }
  for (const std::string& what : order) {
    std::vector<std::string> names = elements[what];
    const std::size_t count = names.size();
    names.resize(std::min(count, kMostNamesInANote));
    fmt::print(stderr, "left out: {}: {}{}\n", what, fmt::join(names, ", "),
               count > names.size() ? fmt::format(" and {} more", count - names.size()) : "");
  }
}

/// Tells what is lost. Whether so much must not be.
bool is_too_little(const std::vector<importing::Finding>& lost, bool strict) {
  for (const importing::Finding& finding : lost)
    fmt::print(stderr, "not representable: {}: {}\n", finding.element, finding.what);
  return strict && !lost.empty();
}

importing::Model read_for_import(const ImportArguments& given) {
  importing::ReadSettings settings;
  settings.paths.assign(given.paths.begin(), given.paths.end());
  if (given.mass_kg > 0) settings.mass_kg = given.mass_kg;
  try {
    return importing::read_model(given.file, settings);
  } catch (const importing::BadModel& bad) {
    throw config::BadConfig(bad.errors());
  }
}

}  // namespace

int run_import(const ImportArguments& given) {
  const std::vector<importing::Instance> instances = instances_of(given);
  const importing::Model model = read_for_import(given);
  print_notes(model);
  if (is_too_little(model.lost, given.strict)) return static_cast<int>(command_line::ExitCode::kBadConfig);
  const std::string file = given.out.empty() ? model.name + ".yaml" : given.out;
  const importing::SceneText scene = importing::scene_text(model, instances, file);
  write_texts(given.out, scene.yaml, scene.meshes);
  return 0;
}

int run_export(const ExportArguments& given) {
  const config::Launch launch = config::read_launch(given.files.file, given.files.overrides);
  std::vector<std::string> names;
  for (const config::SceneSource& source : launch.body_sources) names.push_back(source.name);
  const std::string file = given.out.empty() ? launch.scene.name + ".sdf" : given.out;
  const importing::SdfText world = importing::sdf_text(launch.scene, names, file, physics::hull_triangles);
  if (is_too_little(world.lost, given.strict)) return static_cast<int>(command_line::ExitCode::kBadConfig);
  write_texts(given.out, world.xml, world.meshes);
  return 0;
}

std::unique_ptr<CLI::App> make_import_program(command_line::Action& action) {
  auto program = std::make_unique<CLI::App>("what aurasim import and aurasim export do", "aurasim-import");
  program->require_subcommand(1);
  const auto import = std::make_shared<ImportArguments>();
  add_import_words(*program, *import)->callback([import, &action] {
    action = [import] { return run_import(*import); };
  });
  const auto written = std::make_shared<ExportArguments>();
  add_export_words(*program, *written)->callback([written, &action] {
    action = [written] { return run_export(*written); };
  });
  return program;
}

}  // namespace aurasim::cli
