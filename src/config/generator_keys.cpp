#include "config/generator_keys.h"

#include "config/generators.h"

namespace aurasim::config {
namespace {

constexpr std::int64_t kMostInLine = 100'000;

Key gap_key() {
  return optional("gap", number(Range::from_to(0, 1e6), "m"), "free space between bodies side by side").usual("0");
}

Key count_key() { return required("count", integer(1, kMostInLine), "how many bodies"); }

Key step_key() { return required("step", vec3("m", kPlace), "from the centre of one body to that of the next"); }

const KeyTable& stack_keys() {
  static const KeyTable keys{.title = "generator: stack", .about = "One body upon the other.", .keys = {count_key()}};
  return keys;
}

const KeyTable& wall_keys() {
  static const KeyTable keys{.title = "generator: wall",
                             .about = "In bond along x: every other row is shifted by half a body.",
                             .keys = {required("rows", integer(1, kMostInLine), "one upon the other"),
                                      required("columns", integer(1, kMostInLine), "side by side"), gap_key()}};
  return keys;
}

const KeyTable& pyramid_keys() {
  static const KeyTable keys{.title = "generator: pyramid",
                             .about = "In one plane, along x: `rows` bodies at the bottom, one at the top.",
                             .keys = {required("rows", integer(1, kMostInLine), "one upon the other"), gap_key()}};
  return keys;
}

const KeyTable& block_keys() {
  static const KeyTable keys{
      .title = "generator: block",
      .about = "Rows, columns and layers.",
      .keys = {required("counts", list(3, 3, integer(1, kMostInLine)), "[nx, ny, nz], how many along each axis"),
               optional("spacing", vec3("m", Range::above(0, 1e6)), "of the centres along x, y, z")
                   .otherwise("they touch")}};
  return keys;
}

const KeyTable& row_keys() {
  static const KeyTable keys{.title = "generator: row",
                             .about = "One behind the other, in any direction; `position` is the first body's centre.",
                             .keys = {count_key(), step_key()}};
  return keys;
}

const KeyTable& chain_keys() {
  static const KeyTable keys{
      .title = "generator: chain",
      .about =
          "A row whose bodies point their z axis along `step` and hang together by ball joints halfway between "
          "their centres.",
      .keys = {count_key(), step_key(),
               optional("anchor",
                        choice<Anchor>({{"none", Anchor::kNone},
                                        {"first", Anchor::kFirst},
                                        {"last", Anchor::kLast},
                                        {"both", Anchor::kBoth}}),
                        "which end hangs on the world, half a step beyond the centre of its body")
                   .usual("none")}};
  return keys;
}

}  // namespace

const KeyTable& formation_keys() {
  static const KeyTable keys{
      .title = "every generator",
      .about = "The keys that all generators take.",
      .keys = {
          required("prototype", name_of("prototype"), "what kind of bodies"),
          optional("position", vec3("m", kPlace),
                   "of the middle of the bottom; of a row and a chain: of the first centre")
              .usual("[0, 0, 0]"),
          optional("yaw_deg", number(Range::from_to(-3600, 3600), "degrees"),
                   "turns the whole about the vertical through `position`")
              .usual("0"),
          optional("velocity", vec3("m/s", kSpeed), "of every body at the start").usual("[0, 0, 0]"),
          optional("spin", vec3("rad/s", kSpeed), "angular velocity of every body at the start").usual("[0, 0, 0]"),
          optional("name", text("a name"), "NAME.0, NAME.1 and so on are the bodies' names")
              .otherwise("the bodies have none")}};
  return keys;
}

const KeyTable& generator_keys() {
  static const KeyTable keys{
      .title = "generator",
      .about = "Exactly one of these.",
      .keys = {optional("stack", map(stack_keys).with(formation_keys), "one upon the other"),
               optional("wall", map(wall_keys).with(formation_keys), "in bond"),
               optional("pyramid", map(pyramid_keys).with(formation_keys), "fewer and fewer"),
               optional("block", map(block_keys).with(formation_keys), "rows, columns and layers"),
               optional("row", map(row_keys).with(formation_keys), "one behind the other"),
               optional("chain", map(chain_keys).with(formation_keys), "a row that hangs together")},
      .one_of = {"stack", "wall", "pyramid", "block", "row", "chain"}};
  return keys;
}

}  // namespace aurasim::config
