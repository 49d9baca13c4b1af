#include "cut/saved_world.h"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/version.h"
#include "physics/region_world.h"

namespace aurasim::cut {
namespace {

/// Whole worlds of this run, newest first.
std::vector<StoredWorld> worlds_in(const std::filesystem::path& folder, const SavedBy& by) {
  std::vector<StoredWorld> worlds = PartStore(folder).list().whole;
  std::erase_if(worlds, [&](const StoredWorld& world) {
    return world.header.identity.world != by.world || std::ranges::find(by.runs, world.header.run) == by.runs.end();
  });
  return worlds;
}

bool can_be_read(const StoredWorld& world) {
  try {
    PartStore::read(world);
    return true;
  } catch (const BadCut&) {
    return false;
  }
}

}  // namespace

Identity identity_of(const config::Launch& launch) {
  return {.program = host::version_and_commit(),
          .launch = launch.file.filename().string(),
          .scene = launch.scene.name,
          .physics = fmt::format("{}, {} substeps, {:g} steps/s", launch.physics.solver, launch.time.substeps,
                                 launch.time.step_hz),
          .world = launch.world_identity()};
}

std::shared_ptr<const core::WorldCut> load_world(const LoadArguments& arguments, const config::Launch& launch) {
  if (arguments.file.empty()) return nullptr;
  try {
    SavedWorld world = read_world(arguments.file);
    const std::string differs =
        check_identity(arguments.file, world.identity, identity_of(launch), arguments.other_build);
    if (!differs.empty()) spdlog::warn("{}: {}: bits may differ", arguments.file, differs);
    return std::make_shared<const core::WorldCut>(std::move(world.cut));
  } catch (const BadCut& bad) {
    throw config::BadConfig({bad.what()});
  }
}

std::optional<StoredWorld> newest_saved_world(const std::vector<std::filesystem::path>& folders, const SavedBy& by) {
  std::vector<StoredWorld> worlds;
  for (const std::filesystem::path& folder : folders) {
    for (StoredWorld& world : worlds_in(folder, by)) worlds.push_back(std::move(world));
  }
  std::ranges::stable_sort(worlds, is_newer);
  const auto newest = std::ranges::find_if(worlds, can_be_read);
  return newest == worlds.end() ? std::nullopt : std::optional(std::move(*newest));
}

std::string say_newest_saved(const std::vector<std::filesystem::path>& folders, const SavedBy& by) {
  const std::optional<StoredWorld> saved = newest_saved_world(folders, by);
  if (!saved) return "No whole world of this run is saved on this host.";
  return fmt::format("The newest saved world of this run is of state {}: `{} --load {}` goes on from it.",
                     saved->header.cut.step, by.command, saved->file.string());
}

std::string world_is_lost(const std::vector<std::filesystem::path>& folders, const SavedBy& by) {
  return "nobody knows the world any more: all nodes have died. " + say_newest_saved(folders, by);
}

SavedState newest_saved_until(const std::filesystem::path& folder, const SavedBy& by, core::Step latest) {
  std::vector<StoredWorld> worlds = worlds_in(folder, by);
  std::erase_if(worlds, [latest](const StoredWorld& world) { return world.header.cut.step > latest; });
  std::ranges::stable_sort(worlds, std::ranges::greater(),
                           [](const StoredWorld& world) { return world.header.cut.step; });
  for (const StoredWorld& world : worlds) {
    std::string name = world.file.filename().string();
    if (is_save_name(name) && can_be_read(world)) {
      return {world.header.cut.step, std::move(name)};
    }
  }
  return {};
}

bool is_save_name(std::string_view name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  };
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, fits) && name.front() != '.' &&
         name.front() != '-';
}

}  // namespace aurasim::cut
