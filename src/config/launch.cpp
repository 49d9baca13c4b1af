#include "config/launch.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "config/addresses.h"
#include "config/fields.h"
#include "config/launch_checks.h"
#include "config/launch_keys.h"
#include "config/overrides.h"
#include "config/presets.h"
#include "config/region_layout.h"
#include "config/scene_file.h"
#include "config/shipped_files.h"
#include "core/block.h"
#include "core/fnv1a.h"
#include "core/usual_uncertainty.h"

namespace aurasim::config {
namespace {

/// Applies the preset. Keys given beside it, here or under `time`, override it, so this is called before they are read.
void apply_preset(const Field& physics, Launch& launch) {
  if (!physics.is_map()) return;
  const Field field = Fields(physics)["preset"];
  const auto index = field.given() ? field.choice<std::size_t>() : std::nullopt;
  if (!index) return;
  const Preset& preset = kPresets[*index];
  launch.physics.solver = preset.solver;
  launch.physics.iterations = preset.iterations;
  launch.physics.friction_directions = preset.friction_directions;
  launch.time.substeps = preset.substeps;
}

/// Default profiles if the launch file names none: those beside the launch files of this project, or those that come
/// with the program.
std::filesystem::path usual_profiles(const std::filesystem::path& folder) {
  std::filesystem::path beside = (folder / "../qos/aurasim.xml").lexically_normal();
  std::error_code error;
  if (std::filesystem::is_regular_file(beside, error)) return beside;
  return shipped_profiles();
}

void check_each(const Field& list, std::string_view allowed, bool (*is_good)(const std::string&)) {
  const bool has_items = list.is_list() && !list.node()->children.empty() && list.node()->children.size() <= 256;
  if (!has_items) return;  // reported already
  for (const Field& item : list.items()) {
    if (item.is_text() && !is_good(item.node()->text)) item.refuse(allowed);
  }
}

/// Checks where the hub of discovery: neighbours is found. On loopback no hub of another host is reached.
void check_hub(const Fields& fields, const Dds& dds) {
  const Field hub = fields["hub"];
  if (hub.is_text() && !is_ipv4(hub.node()->text)) hub.refuse("the IPv4 address of the site's hub, such as 10.0.0.7");
  if (dds.discovery != Discovery::kNeighbours) return;
  if (is_on_loopback(dds)) {
    if (hub.given() && !dds.hub.starts_with("127.")) hub.refuse("an address of loopback, as interfaces has no other");
    if (fields.has("peers")) fields["peers"].refuse("nothing where one hub on loopback serves all");
    return;
  }
  if (!hub.given()) {
    fields["interfaces"].refuse(
        "addresses of loopback with discovery: neighbours and no hub; name the hub of this site");
  }
  if (std::ranges::find(dds.interfaces, "*") != dds.interfaces.end()) {
    fields["interfaces"].refuse("addresses with discovery: neighbours, as others are told where this process is");
  }
}

/// Hubs of several hosts have no keys.
void check_neighbours(const Field& field, const Dds& dds) {
  if (dds.discovery != Discovery::kNeighbours) return;
  const Fields fields(field);
  if (!dds.security.empty() && !is_on_loopback(dds)) {
    fields["security"].refuse(
        "nothing with discovery: neighbours on several hosts, whose hubs have no key; with keys use multicast, peers "
        "or server there");
  }
}

void read_dds(const Field& field, const std::filesystem::path& folder, Dds& dds) {
  dds.profiles = usual_profiles(folder);
  if (!field.given()) return;
  const Fields fields(field);
  dds_keys().read_members(fields, dds);
  if (const Field f = fields["profiles"]; f.given()) {
    if (const auto name = f.text()) dds.profiles = (folder / *name).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(dds.profiles, error)) {
      f.refuse(fmt::format("an XML file ({} is none)", dds.profiles.string()));
    }
  }
  if (const Field f = fields["security"]; f.given()) {
    if (const auto name = f.text()) dds.security = (folder / *name).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_directory(dds.security, error)) {
      f.refuse(fmt::format("a folder of keys ({} is none)", dds.security.string()));
    }
  }
  check_each(fields["interfaces"], "an IPv4 address of this host, such as 10.0.0.7, or \"*\": all of them",
             [](const std::string& text) { return text == "*" || is_ipv4(text); });
  check_each(fields["peers"], "ADDRESS or ADDRESS:PORT, IPv4, such as 10.0.0.7 or 10.0.0.7:7410", is_ipv4_with_port);
  if (dds.impair.bandwidth_B_s && *dds.impair.bandwidth_B_s > 0 && *dds.impair.bandwidth_B_s < 1) {
    Fields(fields["impair"])["bandwidth"].refuse("0, or at least 1 B/s");
  }
  check_hub(fields, dds);
  check_neighbours(field, dds);
  const bool needs_peers = dds.discovery == Discovery::kPeers || dds.discovery == Discovery::kServer;
  if (needs_peers && dds.peers.empty() && !fields.has("peers")) {
    field.complain("needs peers, allowed: peers: [ADDRESS, ...] with discovery: peers or server");
  }
  fields.close();
}

/// Hash of a file's content; nothing if there is no such file.
std::optional<std::uint64_t> hash_of_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file)) return std::nullopt;
  core::Fnv1a hash;
  for (char c = 0; in.get(c);) hash.add_octet(static_cast<std::uint8_t>(c));
  return hash.value();
}

void read_control(const Field& field, const std::filesystem::path& folder, Control& control) {
  if (!field.given()) return;
  const Fields fields(field);
  control_keys().read_members(fields, control);
  if (const Field f = fields["replay"]; f.given()) {
    if (const auto name = f.text()) control.replay = (folder / *name).lexically_normal();
    const std::optional<std::uint64_t> content = hash_of_file(control.replay);
    if (!content) f.refuse(fmt::format("setpoints.csv of an earlier run ({} is none)", control.replay.string()));
    control.replay_content = content.value_or(0);
  }
  fields.close();
}

/// Reads the settings of the overseer. Does not check that the files exist; that is done where they are used, because
/// hosts that only run nodes need no key of the viewer.
void read_overseer(const Field& field, const std::filesystem::path& folder, Overseer& overseer) {
  if (!field.given()) return;
  const Fields fields(field);
  overseer_keys().read_members(fields, overseer);
  if (const Field f = fields["bind"]; f.is_text() && !is_address(f.node()->text)) {
    f.refuse("an address to listen on, such as 127.0.0.1, 0.0.0.0 or ::1");
  }
  if (const Field f = fields["tls"]; f.given()) {
    const Fields files(f);
    const auto certificate = files["certificate"].text(), key = files["key"].text();
    files.close();
    if (certificate && key)
      overseer.tls = Tls{(folder / *certificate).lexically_normal(), (folder / *key).lexically_normal()};
  }
  fields.close();
}

void read_scene_of(const Field& field, const std::vector<Override>& overrides, const LaunchLayout& layout,
                   Launch& launch, Errors& errors) {
  const auto name = field.text();
  if (!name) return;
  launch.scene_file = (launch.file.parent_path() / *name).lexically_normal();
  std::string why;
  if (!can_be_read(launch.scene_file, kLargestFileBytes, why)) {
    field.refuse(fmt::format("a scene file ({}: {})", launch.scene_file.string(), why));
    return;
  }
  SceneFile read = read_scene_file(launch.scene_file, overrides, layout, errors);
  launch.scene = std::move(read.scene);
  launch.body_sources = std::move(read.body_sources);
  launch.injector_sources = std::move(read.injector_sources);
}

/// Separates overrides: "scene.gravity=..." changes the scene, while "scene=..." names another scene and belongs to the
/// launch file.
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
  static const Value kFile = map(launch_keys);
  const Fields fields(Field(&root, root.place, "", kFile, true, errors));
  const Field regions = fields["regions"];
  std::optional<RegionLayout> layout;
  std::optional<double> neighbour_distance_m;
  if (regions.given()) {
    layout = read_layout(regions);
    neighbour_distance_m = Fields(regions, regions_keys())["neighbour_distance"].number();
  } else {
    regions.refuse("a map such as {layout: columns, count: 2, width: 40}");
  }
  apply_preset(fields["physics"], launch);
  launch_keys().read_members(fields, launch);
  read_dds(fields["dds"], launch.file.parent_path(), launch.dds);
  read_control(fields["control"], launch.file.parent_path(), launch.control);
  read_overseer(fields["overseer"], launch.file.parent_path(), launch.overseer);
  if (fields.given()) read_scene_of(fields["scene"], of_scene, {.is_known = true, .layout = layout}, launch, errors);
  read_ros2(fields["ros2"], launch);
  check_statics(fields["physics"], launch);
  fields.close();
  if (!errors.empty()) return;
  launch.regions = layout->map;
  check_regions(regions, neighbour_distance_m, launch);
}

}  // namespace

double Launch::uncertainty() const {
  return aura.uncertainty.value_or(core::usual_uncertainty(time.sync, lookahead()));
}

double Launch::exchange_limit_s() const {
  constexpr double kShareOfStep = 0.25;
  const int exchanges = 2 * time.substeps + 1;  // each takes half a round trip
  return exchange_limit_given_s.value_or(2 * kShareOfStep * step_s() / exchanges);
}

bool Launch::redoes() const {
  const bool on = time.redo == Redo::kOn || (time.redo == Redo::kAuto && time.sync == core::SyncMode::kDeterministic);
  return on && regions.size() > 1 && !is_coupled();
}

bool Launch::recovers() const { return survival.on_death == OnDeath::kRecover && regions.size() > 1; }

core::Step Launch::checkpoint_steps() const {
  if (!recovers()) return 0;
  return std::max<core::Step>(1, std::llround(survival.checkpoint_s * time.step_hz));
}

core::ControlRules Launch::control_rules() const {
  return {control.late, control.on_silence, std::max<core::Step>(1, std::llround(control.silence_s * time.step_hz))};
}

int Launch::lookahead() const {
  if (is_coupled()) return 1;
  if (time.lookahead) return *time.lookahead;
  const double steps = (tolerances.frame_s + tolerances.latency_s) * time.step_hz;
  return std::max(1, static_cast<int>(std::ceil(steps - 1e-9)));  // a tolerance of exactly one step is one step
}

double Launch::block_m() const { return physics.block_m ? *physics.block_m : core::usual_block_m(scene); }

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
