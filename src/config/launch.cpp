#include "config/launch.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "config/fields.h"
#include "config/launch_checks.h"
#include "config/overrides.h"
#include "config/presets.h"
#include "config/region_layout.h"
#include "config/scene_file.h"

namespace aurasim::config {
namespace {

void read_time(const Field& field, Time& time) {
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("step_hz"); f.given()) {
    time.step_hz = f.number(Range::from_to(1, 10'000)).value_or(time.step_hz);
  }
  if (const Field f = fields.optional("substeps"); f.given()) {
    time.substeps = static_cast<int>(f.integer(1, 64).value_or(time.substeps));
  }
  if (const Field f = fields.optional("sync"); f.given()) {
    time.sync = f.choice<Sync>({{"free_running", Sync::kFreeRunning},
                                {"bounded", Sync::kBounded},
                                {"deterministic", Sync::kDeterministic}})
                    .value_or(time.sync);
  }
  if (const Field f = fields.optional("lookahead"); f.given() && !f.is_word("auto")) {
    const auto steps = f.integer(1, kLargestLookahead, "auto, or ");
    if (steps) time.lookahead = static_cast<int>(*steps);
  }
  if (const Field f = fields.optional("pace"); f.given()) {
    time.pace = f.choice<Pace>({{"wall", Pace::kWall}, {"none", Pace::kNone}}).value_or(time.pace);
  }
  fields.close();
}

void read_tolerances(const Field& field, Tolerances& tolerances) {
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("speed"); f.given()) {
    tolerances.speed_m_s = f.number(Range::above(0, 1e4)).value_or(tolerances.speed_m_s);
  }
  if (const Field f = fields.optional("latency"); f.given()) {
    tolerances.latency_s = f.number(Range::from_to(0, 10)).value_or(tolerances.latency_s);
  }
  if (const Field f = fields.optional("frame"); f.given()) {
    tolerances.frame_s = f.number(Range::above(0, 10)).value_or(tolerances.frame_s);
  }
  fields.close();
}

void read_aura(const Field& field, Aura& aura) {
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("radius"); f.given()) {
    aura.radius = f.choice<AuraRadius>({{"none", AuraRadius::kNone},
                                        {"thesis", AuraRadius::kThesis},
                                        {"tight", AuraRadius::kTight},
                                        {"swept", AuraRadius::kSwept}})
                      .value_or(aura.radius);
  }
  if (const Field f = fields.optional("uncertainty"); f.given()) {
    aura.uncertainty = f.number(Range::from_to(0, 10)).value_or(aura.uncertainty);
  }
  fields.close();
}

/// What is given beside a preset, here or under `time`, goes before it.
void apply_preset(const Field& field, bool substeps_are_given, Launch& launch) {
  const auto choice = field.choice<const Preset*>(
      {{kPresets[0].name, &kPresets[0]}, {kPresets[1].name, &kPresets[1]}, {kPresets[2].name, &kPresets[2]}});
  if (!choice) return;
  launch.physics.solver = (*choice)->solver;
  launch.physics.iterations = (*choice)->iterations;
  launch.physics.friction_directions = (*choice)->friction_directions;
  if (!substeps_are_given) launch.time.substeps = (*choice)->substeps;
}

void read_physics(const Field& field, bool substeps_are_given, Launch& launch) {
  if (!field.given()) return;
  Physics& physics = launch.physics;
  Fields fields(field);
  if (const Field f = fields.optional("preset"); f.given()) apply_preset(f, substeps_are_given, launch);
  if (const Field f = fields.optional("precision"); f.given()) {
    physics.precision = f.choice<std::string>({{"double", "double"}, {"single", "single"}}).value_or(physics.precision);
  }
  if (const Field f = fields.optional("solver"); f.given()) {
    physics.solver =
        f.choice<std::string>({{"sequential_impulse", "sequential_impulse"}, {"nncg", "nncg"}, {"dantzig", "dantzig"}})
            .value_or(physics.solver);
  }
  if (const Field f = fields.optional("iterations"); f.given()) {
    physics.iterations = static_cast<int>(f.integer(1, 1000).value_or(physics.iterations));
  }
  if (const Field f = fields.optional("friction_directions"); f.given()) {
    physics.friction_directions = static_cast<int>(f.integer(1, 2).value_or(physics.friction_directions));
  }
  if (const Field f = fields.optional("erp"); f.given()) {
    physics.contact_erp = f.number(Range::from_to(0, 1)).value_or(physics.contact_erp);
  }
  if (const Field f = fields.optional("continuous"); f.given()) {
    physics.continuous = f.flag().value_or(physics.continuous);
  }
  if (const Field f = fields.optional("origin"); f.given()) {
    physics.origin =
        f.choice<Origin>({{"world", Origin::kWorld}, {"region", Origin::kRegion}}).value_or(physics.origin);
  }
  fields.close();
}

std::vector<std::string> read_addresses(const Field& field) {
  std::vector<std::string> addresses;
  for (const Field& item : field.items(1, 256)) {
    if (const auto text = item.text("an address")) addresses.push_back(*text);
  }
  return addresses;
}

/// The profiles beside the launch files of this project, or those that were built in, if the launch file names none.
std::filesystem::path usual_profiles(const std::filesystem::path& folder) {
  std::filesystem::path beside = (folder / "../qos/aurasim.xml").lexically_normal();
  std::error_code error;
  if (std::filesystem::is_regular_file(beside, error)) return beside;
  return shipped_profiles();
}

void read_impair(const Field& field, Impair& impair) {
  if (!field.given()) return;
  Fields fields(field);
  const Range any_time = Range::from_to(0, 10);
  if (const Field f = fields.optional("delay"); f.given()) impair.delay_s = f.number(any_time);
  if (const Field f = fields.optional("jitter"); f.given()) impair.jitter_s = f.number(any_time);
  if (const Field f = fields.optional("loss"); f.given()) impair.loss = f.number(Range::from_to(0, 1));
  if (const Field f = fields.optional("bandwidth"); f.given()) {
    impair.bandwidth_B_s = f.number(Range::from_to(0, 1e12));
  }
  if (const Field f = fields.optional("reorder"); f.given()) impair.reorder = f.flag();
  if (const Field f = fields.optional("discovery"); f.given()) impair.discovery = f.flag();
  if (const Field f = fields.optional("seed"); f.given()) {
    if (const auto seed = f.integer(0, INT64_MAX)) impair.seed = static_cast<std::uint64_t>(*seed);
  }
  fields.close();
}

void read_dds(const Field& field, const std::filesystem::path& folder, Dds& dds) {
  dds.profiles = usual_profiles(folder);
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("domain"); f.given())
    dds.domain = static_cast<int>(f.integer(0, 232).value_or(0));
  if (const Field f = fields.optional("profiles"); f.given()) {
    if (const auto name = f.text("an XML file")) dds.profiles = (folder / *name).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(dds.profiles, error)) {
      f.refuse(fmt::format("an XML file ({} is none)", dds.profiles.string()));
    }
  }
  if (const Field f = fields.optional("discovery"); f.given()) {
    dds.discovery =
        f.choice<Discovery>(
             {{"multicast", Discovery::kMulticast}, {"peers", Discovery::kPeers}, {"server", Discovery::kServer}})
            .value_or(dds.discovery);
  }
  if (const Field f = fields.optional("interfaces"); f.given()) dds.interfaces = read_addresses(f);
  if (const Field f = fields.optional("peers"); f.given()) dds.peers = read_addresses(f);
  read_impair(fields.optional("impair"), dds.impair);
  if (dds.discovery != Discovery::kMulticast && dds.peers.empty() && !fields.has("peers")) {
    fields.whole().complain("needs peers, allowed: peers: [ADDRESS, ...] with discovery: peers or server");
  }
  fields.close();
}

void read_observe(const Field& field, Observe& observe) {
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("tick_hz"); f.given()) {
    observe.tick_hz = f.number(Range::above(0, 1000)).value_or(observe.tick_hz);
  }
  fields.close();
}

void read_overseer(const Field& field, Overseer& overseer) {
  if (!field.given()) return;
  Fields fields(field);
  if (const Field f = fields.optional("bind"); f.given()) overseer.bind = f.text("an address").value_or(overseer.bind);
  if (const Field f = fields.optional("port"); f.given())
    overseer.port = static_cast<int>(f.integer(0, 65535).value_or(overseer.port));
  fields.close();
}

struct Regions {
  std::optional<RegionLayout> layout;
  std::optional<double> neighbour_distance_m;
};

Regions read_regions(const Field& field) {
  Regions regions;
  Fields fields(field);
  regions.layout = read_layout(fields);
  if (const Field f = fields.optional("neighbour_distance"); f.given()) {
    regions.neighbour_distance_m = f.number(Range::from_to(0, 1e6));
  }
  fields.close();
  return regions;
}

void read_scene_of(const Field& field, const std::vector<Override>& overrides, const LaunchLayout& layout,
                   Launch& launch, Errors& errors) {
  const auto name = field.text("a scene file");
  if (!name) return;
  launch.scene_file = (launch.file.parent_path() / *name).lexically_normal();
  std::string why;
  if (!read_bytes(launch.scene_file, kLargestFileBytes, why)) {
    field.refuse(fmt::format("a scene file ({}: {})", launch.scene_file.string(), why));
    return;
  }
  launch.scene = read_scene_file(launch.scene_file, overrides, layout, errors);
}

/// "scene.gravity=..." changes the scene, "scene=..." names another one.
void split_overrides(std::vector<Override> all, std::vector<Override>& of_launch, std::vector<Override>& of_scene) {
  for (Override& change : all) {
    if (change.path.size() > 1 && change.path[0] == "scene") {
      change.path.erase(change.path.begin());
      of_scene.push_back(std::move(change));
    } else {
      of_launch.push_back(std::move(change));
    }
  }
}

void read_launch_map(const YamlNode& root, const std::vector<Override>& of_scene, Launch& launch, Errors& errors) {
  Fields fields(Field(&root, root.place, "", true, errors));
  const Field scene = fields.required("scene");
  const Field regions_field = fields.required("regions");
  if (fields.given() && !regions_field.given())
    regions_field.refuse("a map such as {layout: columns, count: 2, width: 40}");
  Regions regions;
  if (regions_field.given()) regions = read_regions(regions_field);
  const Field time = fields.optional("time");
  read_time(time, launch.time);
  read_tolerances(fields.optional("tolerances"), launch.tolerances);
  read_aura(fields.optional("aura"), launch.aura);
  const bool substeps_are_given = time.is_map() && time.node()->find("substeps") != nullptr;
  read_physics(fields.optional("physics"), substeps_are_given, launch);
  read_dds(fields.optional("dds"), launch.file.parent_path(), launch.dds);
  read_observe(fields.optional("observe"), launch.observe);
  read_overseer(fields.optional("overseer"), launch.overseer);
  if (fields.given()) read_scene_of(scene, of_scene, {.is_known = true, .layout = regions.layout}, launch, errors);
  fields.close();
  if (!errors.empty()) return;
  launch.regions = regions.layout->map;
  check_regions(regions_field, regions.neighbour_distance_m, launch);
}

}  // namespace

std::filesystem::path shipped_profiles() { return std::filesystem::path(AURASIM_QOS_DIR) / "aurasim.xml"; }

int Launch::lookahead() const {
  if (time.lookahead) return *time.lookahead;
  const double steps = (tolerances.frame_s + tolerances.latency_s) * time.step_hz;
  return std::max(1, static_cast<int>(std::ceil(steps - 1e-9)));  // a tolerance of exactly one step is one step
}

Launch read_launch(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  Errors errors;
  Launch launch;
  launch.file = std::filesystem::absolute(file).lexically_normal();
  launch.overrides = overrides;
  std::optional<YamlNode> root = read_yaml(file, errors);
  std::vector<Override> of_launch, of_scene;
  split_overrides(parse_overrides(overrides, errors), of_launch, of_scene);
  if (root) {
    for (const Override& change : of_launch) apply_override(change, *root, errors);
    if (YamlNode* regions = root->find("regions")) settle_overridden_layout(*regions);
    read_launch_map(*root, of_scene, launch, errors);
  }
  errors.throw_if_any();
  return launch;
}

}  // namespace aurasim::config
