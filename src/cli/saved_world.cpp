#include "cli/saved_world.h"

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/version.h"
#include "physics/region_world.h"

namespace aurasim::cli {
namespace {

/// Its name, of a whole world or of a part of it.
std::string world_of(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.substr(0, name.find(".part-"));
}

/// The same on all nodes that save a world together.
std::uint64_t save_number(std::uint64_t life, std::uint64_t request, core::Step step) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  return ((life * kOdd ^ request) * kOdd ^ static_cast<std::uint64_t>(step)) * kOdd;
}

}  // namespace

cut::Identity identity_of(const config::Launch& launch) {
  return {.program = version_and_commit(),
          .precision = launch.physics.precision,
          .launch = launch.file.filename().string(),
          .scene = launch.scene.name,
          .physics = fmt::format("{}, {} substeps, {:g} steps/s", launch.physics.solver, launch.time.substeps,
                                 launch.time.step_hz),
          .world = launch.world_identity()};
}

void LoadArguments::add_to(CLI::App& command) {
  CLI::Option* load = command.add_option("--load", file, "a saved world to go on from (aurasim send save)");
  command.add_flag("--other-build", other_build, "with --load: also one that another build has saved")->needs(load);
}

void SaveArguments::add_to(CLI::App& command) {
  command.add_option("--saves", folder, "folder for the nodes' parts of saved worlds");
  command.add_option("--save-every", every_s, "save the world so often, in simulated seconds. 0: only when asked to")
      ->check(CLI::Range(0.0, 1e9));
  command.add_option("--save-keep", keep, "with --save-every: so many of them stay, the newest")
      ->check(CLI::Range(1, 1'000'000));
}

std::shared_ptr<const core::WorldCut> load_world(const LoadArguments& arguments, const config::Launch& launch) {
  if (arguments.file.empty()) return nullptr;
  try {
    cut::SavedWorld world = cut::read_world(arguments.file);
    const std::string differs =
        cut::check_identity(arguments.file, world.identity, identity_of(launch), arguments.other_build);
    if (!differs.empty()) spdlog::warn("{}: {}: bits may differ", arguments.file, differs);
    return std::make_shared<const core::WorldCut>(std::move(world.cut));
  } catch (const cut::BadCut& bad) {
    throw config::BadConfig({bad.what()});
  }
}

const char* problem_with_save_name(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  };
  if (name.empty() || name.size() > 100) return "a saved world's name has 1 to 100 letters";
  if (!std::ranges::all_of(name, fits) || name.front() == '.' || name.front() == '-') {
    return "a saved world's name has letters, digits, '.', '_' and '-', and does not begin with '.' or '-'";
  }
  return nullptr;
}

std::string refused_save_name(const std::string& name) {
  const char* const problem = problem_with_save_name(name);
  if (problem == nullptr) return {};
  return fmt::format("{}: found '{}'. It is a file in the nodes' folder of saved worlds (--saves)", problem, name);
}

std::string newest_saved_world(const std::filesystem::path& folder) {
  std::pair<core::Step, std::string> newest{-1, {}};
  std::error_code no_folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder, no_folder)) {
    const std::string name = entry.path().filename().string();
    core::Step step = 0;
    if (std::sscanf(name.c_str(), "state-%" SCNd64 ".cut", &step) != 1) continue;
    newest = std::max(newest, {step, (folder / fmt::format("state-{}.cut", step)).string()});
  }
  return newest.second;
}

std::string world_is_lost(const std::filesystem::path& saves) {
  const std::string saved = newest_saved_world(saves);
  return fmt::format("nobody knows the world any more: all nodes have died. The newest saved world here: {}",
                     saved.empty() ? "none" : saved);
}

SavedState newest_saved_until(const std::filesystem::path& folder, const config::Launch& launch, core::Step latest) {
  SavedState newest;
  const std::uint64_t wanted = launch.world_identity();
  std::error_code no_folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder, no_folder)) {
    const std::string name = world_of(entry.path());
    if (problem_with_save_name(name) != nullptr || !entry.is_regular_file() || entry.path().extension() == ".new") {
      continue;
    }
    try {
      const cut::SavedWorld header = cut::read_header(entry.path());
      const core::Step step = header.cut.step;
      if (header.identity.world == wanted && step <= latest && step > newest.step) newest = {step, name};
    } catch (const cut::BadCut&) {
      continue;  // whatever else lies there
    }
  }
  return newest;
}

bool PartWriter::expects(core::Step step) const {
  return std::ranges::find(expected_, step, &core::Order::at_step) != expected_.end();
}

void PartWriter::write(core::WorldCut part, const config::Launch& launch, std::uint64_t life) {
  const auto order = std::ranges::find(expected_, part.step, &core::Order::at_step);
  if (order == expected_.end()) return;
  const core::Order wanted = *order;
  expected_.erase(order);
  write(std::move(part), launch, life, wanted.request, std::get<core::Save>(wanted.action).file);
}

void PartWriter::write(core::WorldCut part, const config::Launch& launch, std::uint64_t life, std::uint64_t request,
                       const std::string& file_name) {
  const std::filesystem::path name = folder_ / file_name;
  cut::SavedWorld world{identity_of(launch), core::value_of(region_), static_cast<std::uint32_t>(launch.regions.size()),
                        save_number(life, request, part.step), std::move(part)};
  writing_.push_back(std::async(std::launch::async, [folder = folder_, name, request, world = std::move(world)] {
    Written written{request, world.cut.step, {}, {}};
    try {
      std::filesystem::create_directories(folder);
      const std::filesystem::path file =
          std::filesystem::absolute(world.parts == 1 ? name : cut::part_file(name, world.part, world.parts));
      cut::write_cut(file, world);
      written.file = file.string();
    } catch (const std::exception& error) {
      written.error = error.what();
    }
    return written;
  }));
}

std::vector<PartWriter::Written> PartWriter::take_written() {
  std::vector<Written> done;
  std::erase_if(writing_, [&](std::future<Written>& one) {
    if (one.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    done.push_back(one.get());
    forget_old_ones(done.back());
    return true;
  });
  return done;
}

/// Of those that nobody has asked for.
void PartWriter::forget_old_ones(const Written& written) {
  if (written.request != 0 || !written.error.empty()) return;
  std::erase(regular_, written.file);  // the run has gone back, and come there again
  regular_.push_back(written.file);
  if (regular_.size() <= keep_) return;
  std::error_code ignored;
  std::filesystem::remove(regular_.front(), ignored);
  regular_.pop_front();
}

}  // namespace aurasim::cli
