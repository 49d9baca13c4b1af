#include "config/injectors.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <fmt/format.h>

#include "config/bodies.h"
#include "config/injector_keys.h"

namespace aurasim::config {
namespace {

using core::Rectangle;
using core::Vec3;

/// A volume in which a part of an injector's bodies appears.
struct Volume {
  Vec3 centre = Vec3::Zero();
  Vec3 size = Vec3::Zero();
  double share = 1;  ///< share of the injector's bodies
};

/// The side of a region towards another region.
struct Side {
  double x = 0, y = 0;    ///< middle of the boundary that the two share
  double nx = 0, ny = 0;  ///< unit vector from the boundary into the region
};

std::optional<Side> side_towards(const Rectangle& own, const Rectangle& other) {
  const double x0 = std::max(own.x0, other.x0), x1 = std::min(own.x1, other.x1);
  const double y0 = std::max(own.y0, other.y0), y1 = std::min(own.y1, other.y1);
  if (x0 == x1 && y0 < y1) return Side{x0, 0.5 * (y0 + y1), own.x0 == x0 ? 1.0 : -1.0, 0};
  if (y0 == y1 && x0 < x1) return Side{0.5 * (x0 + x1), y0, 0, own.y0 == y0 ? 1.0 : -1.0};
  return std::nullopt;
}

std::vector<Side> sides_of(const std::vector<Rectangle>& tiles, std::size_t region) {
  std::vector<Side> sides;
  for (std::size_t other = 0; other < tiles.size(); ++other) {
    if (other == region) continue;
    if (const auto side = side_towards(tiles[region], tiles[other])) sides.push_back(*side);
  }
  return sides;
}

std::vector<Volume> volumes_per_region(const Fields& fields, const std::vector<Rectangle>& tiles) {
  const auto size = fields["size"].vec3();
  const auto height = fields["height"].number();
  fields.close();
  std::vector<Volume> volumes;
  if (!size || !height) return volumes;
  for (const Rectangle& tile : tiles) {
    volumes.push_back({{0.5 * (tile.x0 + tile.x1), 0.5 * (tile.y0 + tile.y1), *height},
                       *size,
                       1.0 / static_cast<double>(tiles.size())});
  }
  return volumes;
}

std::vector<Volume> volumes_per_boundary(const Fields& fields, const std::vector<Rectangle>& tiles) {
  const auto distance = fields["distance"].number();
  const auto size = fields["size"].vec3();  // across, along, up
  const auto height = fields["height"].number();
  fields.close();
  std::vector<Volume> volumes;
  if (!distance || !size || !height) return volumes;
  for (std::size_t region = 0; region < tiles.size(); ++region) {
    const std::vector<Side> sides = sides_of(tiles, region);
    for (const Side& side : sides) {
      const Vec3 centre(side.x + side.nx * *distance, side.y + side.ny * *distance, *height);
      const bool across_x = side.nx != 0;
      const Vec3 turned = across_x ? *size : Vec3(size->y(), size->x(), size->z());
      volumes.push_back({centre, turned, 1.0 / static_cast<double>(tiles.size() * sides.size())});
    }
  }
  if (volumes.empty()) {
    fields.whole().complain(
        "found a layout of one region, allowed: one with boundaries (the scene may have a layout of its own, "
        "e.g. layout: {layout: columns, count: 2, width: 80})");
  }
  return volumes;
}

std::vector<Volume> read_per(const Field& field, const SceneDraft& draft) {
  const Fields fields(field);
  const Field regions = fields["regions"];
  const Field boundaries = fields["boundaries"];
  fields.close();
  if (!fields.given()) return {};
  if (fields.given_of(per_keys()).size() != 1) {
    field.refuse("one of regions, boundaries");
    return {};
  }
  if (!draft.layout) {
    if (!draft.layout_is_wrong)
      field.complain("needs the scene's layout, allowed: layout: launch, or a layout of its own");
    return {};
  }
  return regions.given() ? volumes_per_region(Fields(regions), draft.layout->tiles)
                         : volumes_per_boundary(Fields(boundaries), draft.layout->tiles);
}

std::optional<Volume> read_volume(const Field& field) {
  const Fields fields(field);
  const auto centre = fields["center"].vec3();
  const auto size = fields["size"].vec3();
  fields.close();
  if (!centre || !size) return std::nullopt;
  return Volume{*centre, *size, 1};
}

std::vector<Volume> read_volumes(const Fields& fields, const SceneDraft& draft) {
  const Field one = fields["volume"];
  const Field several = fields["volumes"];
  const Field per = fields["per"];
  if (!fields.given()) return {};
  if (fields.given_of(injector_keys()).size() != 1) {
    fields.whole().refuse("one of volume, volumes, per");
    return {};
  }
  if (per.given()) return read_per(per, draft);
  std::vector<Volume> volumes;
  if (one.given()) {
    if (const auto volume = read_volume(one)) volumes.push_back(*volume);
    return volumes;
  }
  for (const Field& item : several.items()) {
    if (const auto volume = read_volume(item)) volumes.push_back(*volume);
  }
  for (Volume& volume : volumes) volume.share = 1.0 / static_cast<double>(volumes.size());
  return volumes;
}

void read_velocity(const Field& field, core::Injector& injector) {
  if (!field.given()) return;
  const Fields fields(field);
  const auto low = fields["min"].vec3();
  const auto high = fields["max"].vec3();
  fields.close();
  if (!low || !high) return;
  if ((low->array() > high->array()).any()) {
    field.complain("found a min above its max, allowed: min at most max in each component");
    return;
  }
  injector.velocity_min = *low;
  injector.velocity_max = *high;
}

/// Reads everything but the volumes, as if all bodies came from one.
core::Injector read_common(const Fields& fields, std::size_t index, const SceneDraft& draft) {
  core::Injector injector;
  keys_of_injector().read_members(fields, injector);
  injector.name = fields["name"].text().value_or(fmt::format("injector {}", index));
  const Field count_field = fields["count"];
  const auto count = count_field.integer();
  if (count && draft.has_room_for(static_cast<std::uint64_t>(*count), count_field)) {
    injector.max_bodies = static_cast<std::uint64_t>(*count);
  }
  read_velocity(fields["velocity"], injector);
  if (fields.given()) {
    for (const Field& item : fields["prototypes"].items()) {
      injector.prototypes.push_back(core::PrototypeId{draft.prototypes.find(item).value_or(0)});
    }
  }
  return injector;
}

/// Derives seed number `index` from one seed (splitmix64).
std::uint64_t derived_seed(std::uint64_t seed, std::size_t index) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ull * (index + 1);
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 27) * 0x94d049bb133111ebull;
  return z ^ z >> 31;
}

core::BodyId next_free_id(const core::Scene& scene) {
  if (!scene.injectors.empty()) {
    return core::BodyId{value_of(scene.injectors.back().first_id) + scene.injectors.back().max_bodies};
  }
  return core::BodyId{scene.bodies.empty() ? 0 : value_of(scene.bodies.back().id) + 1};
}

/// Checks that the injector's volume is within the reach of a scene.
void check_volume(const core::Injector& injector, const Field& blame) {
  for (const Vec3& corner_W : {injector.volume_min, injector.volume_max}) {
    if (!is_within_reach(corner_W)) return complain_of_place(blame, "a corner of a volume", corner_W);
  }
}

void check_ids(const Field& blame, const SceneDraft& draft) {
  const std::uint64_t next = value_of(next_free_id(draft.scene));
  if (static_cast<std::int64_t>(next) <= kLargestBodyId + 1) return;
  blame.complain(fmt::format("found ids up to {}, allowed: at most {}", next - 1, kLargestBodyId));
}

/// One injector for each volume. They start one after the other, so that all of them together are evenly paced.
void add_injectors(const core::Injector& whole, const std::vector<Volume>& volumes, const Field& blame,
                   SceneDraft& draft) {
  double share_so_far = 0;
  std::uint64_t bodies_so_far = 0;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const Volume& volume = volumes[i];
    core::Injector part = whole;
    if (volumes.size() > 1) {
      part.name = fmt::format("{} {}", whole.name, i);
      part.seed = derived_seed(whole.seed, i);
    }
    share_so_far += volume.share;
    const auto up_to =
        i + 1 == volumes.size()
            ? whole.max_bodies
            : static_cast<std::uint64_t>(std::llround(share_so_far * static_cast<double>(whole.max_bodies)));
    part.max_bodies = up_to - bodies_so_far;
    bodies_so_far = up_to;
    if (part.max_bodies == 0) continue;
    part.rate_per_s = whole.rate_per_s * volume.share;
    part.start_s = whole.start_s + static_cast<double>(i) / whole.rate_per_s;
    part.volume_min = volume.centre - volume.size / 2;
    part.volume_max = volume.centre + volume.size / 2;
    part.first_id = next_free_id(draft.scene);
    check_volume(part, blame);
    draft.scene.injectors.push_back(std::move(part));
  }
}

}  // namespace

void read_injectors(const Field& field, SceneDraft& draft) {
  if (!field.given()) return;
  std::unordered_set<std::string> names;
  std::size_t index = 0;
  for (const Field& item : field.items()) {
    const Fields fields(item);
    const core::Injector whole = read_common(fields, index++, draft);
    const std::vector<Volume> volumes = read_volumes(fields, draft);
    fields.close();
    if (!names.insert(whole.name).second) {
      item.complain(fmt::format("found the name {} a second time, allowed: each name once", in_quotes(whole.name)));
    }
    draft.injected_bodies += whole.max_bodies;
    if (draft.scene.injectors.size() + volumes.size() > kMostInjectors) {
      item.complain(fmt::format("found {} volumes, allowed: {} in the whole scene", volumes.size(), kMostInjectors));
      continue;
    }
    add_injectors(whole, volumes, item, draft);
    draft.injector_sources.resize(draft.scene.injectors.size(), source_of(item, whole.name));
    check_ids(item, draft);
  }
}

void add_injector(core::Injector injector, const Field& blame, SceneDraft& draft) {
  if (draft.scene.injectors.size() >= kMostInjectors) {
    return blame.complain(fmt::format("found one more injector, allowed: {} in the whole scene", kMostInjectors));
  }
  injector.first_id = next_free_id(draft.scene);
  check_volume(injector, blame);
  draft.injected_bodies += injector.max_bodies;
  draft.injector_sources.push_back(source_of(blame, injector.name));
  draft.scene.injectors.push_back(std::move(injector));
  check_ids(blame, draft);
}

}  // namespace aurasim::config
