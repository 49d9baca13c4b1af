#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/text_files.h"
#include "config/launch.h"
#include "import/read_model.h"
#include "import/scene_writer.h"

namespace aurasim::cli {
namespace {

constexpr std::size_t kMostNamesInANote = 3;

struct ImportArguments {
  std::string file;
  std::string out;
  std::vector<std::string> names;  ///< --as
  std::vector<std::string> poses;  ///< --at
  std::vector<std::string> paths;
  double mass_kg = 0;  ///< 0: not given
  bool strict = false;
};

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

std::vector<import::Instance> instances_of(const ImportArguments& given) {
  if (given.names.empty() && given.poses.size() <= 1) {
    return {{"", given.poses.empty() ? core::Pose{} : pose_from(given.poses.front())}};
  }
  if (given.poses.size() > given.names.size() || (given.names.size() > 1 && given.poses.size() != given.names.size()))
    throw config::BadConfig({fmt::format("found {} --as and {} --at, allowed: one --at for each --as",
                                         given.names.size(), given.poses.size())});
  std::vector<import::Instance> instances;
  for (std::size_t i = 0; i < given.names.size(); ++i) {
    for (const import::Instance& other : instances) {
      if (other.prefix == given.names[i])
        throw config::BadConfig({fmt::format("--as {}: the name is there twice", given.names[i])});
    }
    instances.push_back({given.names[i], given.poses.empty() ? core::Pose{} : pose_from(given.poses[i])});
  }
  return instances;
}

/// Each thing that was left out once, with a few of the elements that have it.
void print_notes(const import::Model& model) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<std::string>> elements;
  for (const import::Finding& note : model.notes) {
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

import::Model read_for_import(const ImportArguments& given){import::ReadSettings settings;
settings.paths.assign(given.paths.begin(), given.paths.end());
if (given.mass_kg > 0) settings.mass_kg = given.mass_kg;
try {
  return import::read_model(given.file, settings);
} catch (const import::BadModel& bad) {
  throw config::BadConfig(bad.errors());
}
}  // namespace

int run_import(const ImportArguments& given) {
  const std::vector<import::Instance> instances = instances_of(given);
  const import::Model model = read_for_import(given);
  print_notes(model);
  for (const import::Finding& finding : model.lost)
    fmt::print(stderr, "not representable: {}: {}\n", finding.element, finding.what);
  if (given.strict && !model.lost.empty()) return static_cast<int>(ExitCode::kBadConfig);
  const std::string file = given.out.empty() ? model.name + ".yaml" : given.out;
  const import::SceneText scene = import::scene_text(model, instances, file);
  write_texts(given.out, scene.yaml, scene.meshes);
  return 0;
}

}  // namespace aurasim::cli

void add_import(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("import", "make a scene file of a URDF, SDF, MJCF or mesh file");
  const auto given = std::make_shared<ImportArguments>();
  command->add_option("FILE", given->file, "URDF, SDF, MJCF (told by what is in it), OBJ, STL, glTF or DAE")
      ->required();
  command->add_option("--out", given->out, "the scene file to write; without it, it is printed");
  command->add_option("--as", given->names, "a copy of the model, whose names all begin with NAME/")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command->add_option("--at", given->poses, "where the copy stands: x,y,z in metres, then roll,pitch,yaw in degrees")
      ->type_name("X,Y,Z[,R,P,Y]")
      ->allow_extra_args(false);
  command->add_option("--path", given->paths, "another folder in which meshes and included models may lie")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
  command->add_option("--mass", given->mass_kg, "kg: makes a mesh file a body that moves; without it, it is a static")
      ->check(CLI::PositiveNumber)
      ->default_str("");
  command->add_flag("--strict", given->strict, "write nothing, and end with code 2, if a scene cannot say all of it");
  command->footer(
      "Example:\n  aurasim import robot.urdf --out robots.yaml --as left --at 0,-1,0 --as right --at 0,1,0,0,0,90");
  command->callback([given, &action] { action = [given] { return run_import(*given); }; });
}

}  // namespace aurasim::cli
