#include "config/injector_keys.h"

#include <cstdint>

#include "config/injectors.h"

namespace aurasim::config {
namespace {

using core::Injector;

constexpr Range kExtent = Range::from_to(0, 1e6);
constexpr std::size_t kMostPrototypes = 1000;

const KeyTable& volume_keys() {
  static const KeyTable keys{.title = "injector: volume",
                             .about = "A box in which bodies appear, anywhere.",
                             .keys = {required("center", vec3("m", kPlace), "of the box"),
                                      required("size", vec3("m", kExtent), "whole edges, along x, y, z")}};
  return keys;
}

const KeyTable& velocity_keys() {
  static const KeyTable keys{.title = "injector: velocity",
                             .about = "Each body gets one between the two, drawn for each component.",
                             .keys = {required("min", vec3("m/s", kSpeed), "at most `max`, in each component"),
                                      required("max", vec3("m/s", kSpeed), "at least `min`, in each component")}};
  return keys;
}

const KeyTable& per_region_keys() {
  static const KeyTable keys{
      .title = "injector: per: regions",
      .about = "A volume around the middle of each region of the scene's `layout`. Each gets the same share.",
      .keys = {required("size", vec3("m", kExtent), "whole edges, along x, y, z"),
               required("height", number(kPlace, "m"), "of the centres, above z = 0")}};
  return keys;
}

const KeyTable& per_boundary_keys() {
  static const KeyTable keys{
      .title = "injector: per: boundaries",
      .about =
          "A volume on each side of each boundary of the scene's `layout`. Each region gets the same share, and of "
          "it each of its sides.",
      .keys = {required("distance", number(kExtent, "m"), "of the centres from the boundary"),
               required("size", vec3("m", kExtent), "[across, along, up]: whole edges, as seen from the boundary"),
               required("height", number(kPlace, "m"), "of the centres, above z = 0")}};
  return keys;
}

}  // namespace

const KeyTable& per_keys() {
  static const KeyTable keys{.title = "injector: per",
                             .about = "Exactly one of these. Needs the scene's `layout`.",
                             .keys = {optional("regions", map(per_region_keys), "one volume in each region"),
                                      optional("boundaries", map(per_boundary_keys), "two volumes at each boundary")},
                             .one_of = {"regions", "boundaries"}};
  return keys;
}

const KeysOf<Injector>& keys_of_injector() {
  static const KeysOf<Injector> keys(
      "injector",
      "Throws bodies in, over time; the same ones in every run. Exactly one of `volume`, `volumes` and `per`.",
      {
          own_name_key("each once", "`injector N`, N from 0 in the order of the file"),
          optional("seed", &Injector::seed, integer(0, INT64_MAX), "of its random numbers"),
          required("count", integer(1, static_cast<std::int64_t>(kMostBodies)), "how many bodies, then it ends"),
          required("rate", &Injector::rate_per_s, number(Range::from_to(1e-6, 1e5), "bodies/s"), "evenly paced"),
          optional("start", &Injector::start_s, number(Range::from_to(0, 1e6), "s"),
                   "simulated time of the first body"),
          optional("velocity", map(velocity_keys), "of the bodies when they appear").otherwise("at rest"),
          optional("random_orientation", &Injector::random_orientation, flag(), "each is turned in a way of its own"),
          required("prototypes", list(1, kMostPrototypes, name_of("prototype")), "one of them is drawn for each body"),
          optional("volume", map(volume_keys), "where bodies appear"),
          optional("volumes", list(1, kMostInjectors, map(volume_keys)), "several, which share rate and count"),
          optional("per", map(per_keys), "volumes laid out by the scene's `layout`, which share rate and count"),
      },
      {"volume", "volumes", "per"});
  return keys;
}

const KeyTable& injector_keys() { return keys_of_injector(); }

}  // namespace aurasim::config
