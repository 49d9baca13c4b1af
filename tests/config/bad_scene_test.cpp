#include "config/workspace.h"

namespace aurasim::config {
namespace {

/// A scene of one ball up to its bodies, then `rest` from line 5 on.
std::string with_ball(const std::string& rest) {
  return "shapes:\n  ball: {sphere: {radius: 0.5}}\nprototypes:\n  ball: {shape: ball, mass: 1}\n" + rest;
}

/// A static with `rest`.
std::string moving(const std::string& rest) { return "statics: [{shape: {sphere: {radius: 1}}, " + rest + "}]\n"; }

std::string shape(const std::string& text) { return "shapes:\n  it: " + text + "\n"; }

std::string injector(const std::string& rest) {
  return with_ball("injectors:\n  - {rate: 1, count: 5, prototypes: [ball], " + rest + "}\n");
}

const std::string kBalls = "shapes: {ball: {sphere: {radius: 0.5}}}\nprototypes: {ball: {shape: ball, mass: 1}}\n";

const std::vector<BadCase> kBadScenes = {
    {"UnknownKey",
     with_ball("bodys: []\n"),
     {"scene.yaml:5:1: bodys: unknown key, allowed: name, gravity, layout, include, materials, shapes, prototypes"}},
    {"IsAList", "[1, 2]\n", {"scene.yaml:1:1: the file: found a list of 2, allowed: a map of name, gravity"}},
    {"GravityOfTwo", "gravity: [0, -9.81]\n", {"scene.yaml:1:10: gravity: found a list of 2, allowed: a list of 3"}},
    {"GravityAWord", "gravity: [0, 0, down]\n", {"scene.yaml:1:17: gravity[2]: found \"down\", allowed: a number"}},
    {"PathOfAPlane",
     "statics: [{shape: {plane: {}}, path: {stops: [{at: 1}]}}]\n",
     {"scene.yaml:1:38: statics[0].path: found the path of a plane, allowed: of shapes that end somewhere"}},
    {"PathWithoutStops",
     moving("path: {stops: []}"),
     {"scene.yaml:1:56: statics[0].path.stops: found a list of 0, allowed: a list of 1 to 1000"}},
    {"PathBackInTime",
     moving("path: {stops: [{at: 2}, {at: 1.5}]}"),
     {"scene.yaml:1:66: statics[0].path.stops[1]: found at: 1.5, allowed: at least 0.01 s after the stop before"}},
    {"PathTooFast",
     moving("path: {smooth: false, stops: [{at: 1, position: [101, 0, 0]}]}"),
     {"scene.yaml:1:72: statics[0].path.stops[0]: found a way of up to 101 m/s and 0 rad/s to here, allowed: 100 m/s "
      "and 50 rad/s"}},
    {"PathThatRepeatsElsewhere",
     moving("path: {repeats: true, stops: [{at: 1, position: [1, 0, 0]}]}"),
     {"scene.yaml:1:48: statics[0].path: found a last stop elsewhere, allowed: with `repeats`, the one where it stands "
      "at the start"}},
    {"BeltTooFast",
     moving("belt: [0, 0, 200]"),
     {"scene.yaml:1:55: statics[0].belt[2]: found \"200\", allowed: a number from -100 to 100"}},
    {"NegativeFriction",
     "materials: {ice: {friction: -1}}\n",
     {"scene.yaml:1:29: materials.ice.friction: found \"-1\", allowed: a number from 0 to 100"}},
    {"RestitutionAboveOne",
     "materials: {rubber: {restitution: 1.5}}\n",
     {"scene.yaml:1:35: materials.rubber.restitution: found \"1.5\", allowed: a number from 0 to 1"}},
    {"MaterialTwice",
     "materials:\n  ice: {}\n  ice: {}\n",
     {"scene.yaml:3:3: materials.ice: found a second time, first at line 2, allowed: once"}},
    {"UnknownShapeKind",
     shape("{teapot: {radius: 1}}"),
     {"scene.yaml:2:8: shapes.it.teapot: unknown key, allowed: sphere, box, capsule"}},
    {"TwoShapesInOne",
     shape("{sphere: {radius: 1}, box: {size: [1, 1, 1]}}"),
     {"scene.yaml:2:7: shapes.it: found a map of 2, allowed: a shape of one kind"}},
    {"EmptyShape", shape("{}"), {"scene.yaml:2:7: shapes.it: found a map of 0, allowed: a shape of one kind"}},
    {"ShapeOfNothing",
     shape("{sphere: }"),
     {"scene.yaml:2:8: shapes.it.sphere: found nothing, allowed: a map, the sizes of the sphere"}},
    {"NegativeRadius",
     shape("{sphere: {radius: -1}}"),
     {"scene.yaml:2:25: shapes.it.sphere.radius: found \"-1\", allowed: a number from 0.0001"}},
    {"FlatBox",
     shape("{box: {size: [1, 0, 1]}}"),
     {"scene.yaml:2:24: shapes.it.box.size[1]: found \"0\", allowed: a number from 0.0001"}},
    {"CapsuleOfTwoHeights",
     shape("{capsule: {radius: 1, height: 1, total_height: 3}}"),
     {"scene.yaml:2:17: shapes.it.capsule: found a map of 3, allowed: one of height"}},
    {"CapsuleShorterThanItsCaps",
     shape("{capsule: {radius: 1, total_height: 1.5}}"),
     {"scene.yaml:2:43: shapes.it.capsule.total_height: found \"1.5\", allowed: a number above 2"}},
    {"HullOfThreePoints",
     shape("{convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}"),
     {"scene.yaml:2:30: shapes.it.convex_hull.points: found a list of 3, allowed: a list of 4 to 1000"}},
    {"FlatHull",
     shape("{convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}}"),
     {"scene.yaml:2:21: shapes.it.convex_hull: found a map of 1, allowed: at least 4 points that do not lie in one"}},
    {"HullOfPointsWithTheKeysOfAMesh",
     shape("{convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], scale: 2}}"),
     {"scene.yaml:2:76: shapes.it.convex_hull.scale: unknown key, allowed: points"}},
    {"HullOfNothing",
     shape("{convex_hull: {}}"),
     {"scene.yaml:2:21: shapes.it.convex_hull: found a map of 0, allowed: one of points, mesh"}},
    {"MeshFileMissing",
     shape("{mesh: {file: nowhere.obj}}"),
     {"scene.yaml:2:21: shapes.it.mesh.file: found \"nowhere.obj\", allowed: a mesh file with triangles (no such "
      "file)"}},
    {"MeshOfUnknownFormat",
     shape("{mesh: {file: scene.yaml}}"),
     {"scene.yaml:2:21: shapes.it.mesh.file: found \"scene.yaml\", allowed: a mesh file with triangles (its name "
      "ends"}},
    {"PlaneWithoutNormal",
     shape("{plane: {normal: [0, 0, 0]}}"),
     {"scene.yaml:2:24: shapes.it.plane.normal: found a normal of length 0"}},
    {"CompoundOfNothing",
     shape("{compound: {parts: []}}"),
     {"scene.yaml:2:26: shapes.it.compound.parts: found a list of 0, allowed: a list of 1 to 1000"}},
    {"CompoundWithAPlane",
     shape("{compound: {parts: [{plane: {}}]}}"),
     {"scene.yaml:2:27: shapes.it.compound.parts[0]: found a map of 1, allowed: one of sphere",
      "scene.yaml:2:28: shapes.it.compound.parts[0].plane: unknown key"}},
    {"PartOfNoMaterial",
     shape("{compound: {parts: [{sphere: {radius: 1}, material: wool}]}}"),
     {"scene.yaml:2:59: shapes.it.compound.parts[0].material: found \"wool\", allowed: a material of this scene"}},
    {"HeightfieldWithUnevenRows",
     shape("{heightfield: {cell: [1, 1], heights: [[0, 0], [0, 0, 0]]}}"),
     {"scene.yaml:2:54: shapes.it.heightfield.heights[1]: found a list of 3, allowed: rows of one length"}},
    {"UnknownShapeName",
     "prototypes: {ball: {shape: bowl, mass: 1}}\n",
     {"scene.yaml:1:28: prototypes.ball.shape: found \"bowl\", allowed: a shape of this scene: nothing"}},
    {"UnknownMaterialName",
     with_ball("bodies: []\n") + "statics: [{shape: ball, material: wool}]\n",
     {"scene.yaml:6:35: statics[0].material: found \"wool\", allowed: a material of this scene: default"}},
    {"NoMass",
     "prototypes: {ball: {shape: {sphere: {radius: 1}}}}\n",
     {"scene.yaml:1:20: prototypes.ball.mass: missing, allowed: a number from 1e-06"}},
    {"MassZero",
     "prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 0}}\n",
     {"scene.yaml:1:57: prototypes.ball.mass: found \"0\", allowed: a number from 1e-06"}},
    {"InertiaOfNoBody",
     "prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1, inertia: [1, 1, 3]}}\n",
     {"scene.yaml:1:69: prototypes.ball.inertia: found a list of 3, allowed: three moments of inertia of which none is "
      "above the sum of the two others"}},
    {"InertiaZero",
     "prototypes: {ball: {shape: {sphere: {radius: 1}}, mass: 1, inertia: [0, 1, 1]}}\n",
     {"scene.yaml:1:70: prototypes.ball.inertia[0]: found \"0\", allowed: a number from 1e-15"}},
    {"MovingPlane",
     "prototypes: {ground: {shape: {plane: {}}, mass: 1}}\n",
     {"scene.yaml:1:30: prototypes.ground.shape: found a mesh, heightfield or plane, allowed: a shape that can move"}},
    {"UnknownPrototypeName",
     with_ball("bodies:\n  - {prototype: bull}\n"),
     {"scene.yaml:6:17: bodies[0].prototype: found \"bull\", allowed: a prototype of this scene: ball"}},
    {"BodiesIsAMap", with_ball("bodies: {ball: 1}\n"), {"scene.yaml:5:9: bodies: found a map of 1, allowed: a list"}},
    {"SameIdTwice",
     with_ball("bodies:\n  - {prototype: ball, id: 7}\n  - {prototype: ball, id: 7}\n"),
     {"scene.yaml:7:5: bodies[1]: found the id 7 a second time, allowed: each id once"}},
    {"IdTooLarge",
     with_ball("bodies:\n  - {prototype: ball, id: 2147483648}\n"),
     {"scene.yaml:6:27: bodies[0].id: found \"2147483648\", allowed: an integer from 0 to 2147482647"}},
    {"SameStaticNameTwice",
     with_ball("statics: [{shape: ball, name: a}, {shape: ball, name: a}]\n"),
     {"scene.yaml:5:35: statics[1]: found the name \"a\" a second time, allowed: each name once"}},
    {"InfinitePosition",
     with_ball("bodies:\n  - {prototype: ball, position: [0, .inf, 0]}\n"),
     {"scene.yaml:6:37: bodies[0].position[1]: found \".inf\", allowed: a number from"}},
    {"QuaternionOfNothing",
     with_ball("bodies:\n  - {prototype: ball, orientation: {quaternion: [0, 0, 0, 0]}}\n"),
     {"scene.yaml:6:49: bodies[0].orientation.quaternion: found a quaternion of length 0, allowed: [w, x, y, z]"}},
    {"QuaternionOfThree",
     with_ball("bodies:\n  - {prototype: ball, orientation: {quaternion: [0, 0, 1]}}\n"),
     {"scene.yaml:6:49: bodies[0].orientation.quaternion: found a list of 3, allowed: a list of 4"}},
    {"TwoOrientations",
     with_ball("bodies:\n  - {prototype: ball, orientation: {quaternion: [1, 0, 0, 0], rpy_deg: [0, 0, 0]}}\n"),
     {"scene.yaml:6:36: bodies[0].orientation: found a map of 2, allowed: one of rpy_deg, quaternion"}},
    {"UnknownGenerator",
     with_ball("generators: [{spiral: {prototype: ball}}]\n"),
     {"scene.yaml:5:14: generators[0]: found a map of 1, allowed: one of stack, wall, pyramid, block, row, chain",
      "scene.yaml:5:15: generators[0].spiral: unknown key, allowed: stack, wall, pyramid, block, row, chain"}},
    {"ChainWithoutLength",
     with_ball("generators: [{chain: {prototype: ball, count: 3, step: [0, 0, 0]}}]\n"),
     {"scene.yaml:5:56: generators[0].chain.step: found a step of length 0"}},
    {"ChainWithAnUnknownAnchor",
     with_ball("generators: [{chain: {prototype: ball, count: 3, step: [1, 0, 0], anchor: middle}}]\n"),
     {"scene.yaml:5:75: generators[0].chain.anchor: found \"middle\", allowed: none, first, last, both"}},
    {"TooManyBodies",
     with_ball("generators: [{wall: {prototype: ball, rows: 2000, columns: 2000}}]\n"),
     {"scene.yaml:5:21: generators[0].wall: found 4000000 bodies after 0 others, allowed: 1000000 in the whole"}},
    {"TooManyBodiesInABlock",
     with_ball("generators: [{block: {prototype: ball, counts: [100000, 100000, 100000]}}]\n"),
     {"scene.yaml:5:48: generators[0].block.counts: found 10000000000 bodies after 0 others"}},
    {"InjectorWithoutVolume",
     with_ball("injectors:\n  - {rate: 1, count: 5, prototypes: [ball]}\n"),
     {"scene.yaml:6:5: injectors[0]: found a map of 3, allowed: one of volume, volumes, per"}},
    {"InjectorOfNothing",
     injector("volume: {center: [0, 0, 0], size: [1, 1, 1]}, rate: 2"),
     {"scene.yaml:6:91: injectors[0].rate: found a second time"}},
    {"InjectorWithNegativeSize",
     injector("volume: {center: [0, 0, 0], size: [1, -1, 1]}"),
     {"scene.yaml:6:83: injectors[0].volume.size[1]: found \"-1\", allowed: a number from 0"}},
    {"InjectorWithMinAboveMax",
     injector("volume: {center: [0, 0, 0], size: [1, 1, 1]}, velocity: {min: [0, 0, 1], max: [0, 0, 0]}"),
     {"scene.yaml:6:101: injectors[0].velocity: found a min above its max"}},
    {"InjectorPerBoundaryWithoutLayout",
     injector("per: {boundaries: {distance: 1, size: [1, 1, 1], height: 1}}"),
     {"scene.yaml:6:50: injectors[0].per: needs the scene's layout, allowed: layout: launch"}},
    {"InjectorOfTooManyBodies",
     with_ball("injectors:\n  - {rate: 1, count: 2000000, prototypes: [ball], volume: {center: [0, 0, 0], size: [1, 1, "
               "1]}}\n"),
     {"scene.yaml:6:22: injectors[0].count: found \"2000000\", allowed: an integer from 1 to 1000000"}},
    {"InjectorIdsPastTheLargest",
     with_ball("bodies: [{prototype: ball, id: 2147482645}]\ninjectors:\n  - {rate: 1, count: 5, prototypes: [ball], "
               "volume: {center: [0, 0, 0], size: [1, 1, 1]}}\n"),
     {"scene.yaml:7:5: injectors[0]: found ids up to 2147482650, allowed: at most 2147482647"}},
    {"InjectorWithoutPrototypes",
     with_ball("injectors:\n  - {rate: 1, count: 5, prototypes: [], volume: {center: [0, 0, 0], size: [1, 1, 1]}}\n"),
     {"scene.yaml:6:37: injectors[0].prototypes: found a list of 0, allowed: a list of 1 to 1000"}},
    {"LayoutAWord", "layout: round\n", {"scene.yaml:1:9: layout: found \"round\", allowed: launch, or a map"}},
    {"NameWithALineEnd", "name: \"a\\nb\"\n", {"scene.yaml:1:7: name: found \"a\\x0ab\", allowed: a name"}},
    {"MassOfNothing",
     "shapes: {ball: {sphere: {radius: 0.5}}}\nprototypes: {ball: {shape: ball, mass: 1e-320}}\n",
     {"scene.yaml:2:40: prototypes.ball.mass: found \"1e-320\", allowed: a number from 1e-06 to 1000000000"}},
    {"BodyThatTheWorldWouldTakeOut",
     kBalls + "bodies: [{prototype: ball, position: [1e7, 0, 0]}]\n",
     {"scene.yaml:3:39: bodies[0].position[0]: found \"1e7\", allowed: a number from -1000000 to 1000000"}},
    {"RowThatLeavesTheWorld",
     kBalls + "generators: [{row: {prototype: ball, count: 3, step: [9e5, 0, 0]}}]\n",
     {"scene.yaml:3:20: generators[0].row: found a body at [1.8e+06, 0, 0] m, allowed: each coordinate from -1e+06 to "
      "1e+06 m"}},
    {"VolumeThatLeavesTheWorld",
     kBalls +
         "injectors: [{count: 3, rate: 1, prototypes: [ball], volume: {center: [9e5, 0, 0], size: [4e5, 1, 1]}}]\n",
     {"scene.yaml:3:13: injectors[0]: found a corner of a volume at [1.1e+06, 0.5, 0.5] m, allowed: each coordinate"}},
    {"RateOfOnceInAnAge",
     kBalls +
         "injectors: [{count: 3, rate: 1e-320, prototypes: [ball], volume: {center: [0, 0, 0], size: [4, 1, 1]}}]\n",
     {"scene.yaml:3:30: injectors[0].rate: found \"1e-320\", allowed: a number from 1e-06 to 100000"}},
    {"HullThatIsTooThin",
     "shapes: {it: {convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5e-5]]}}}\n",
     {"scene.yaml:1:28: shapes.it.convex_hull: found a shape that is 5e-05 m thin, allowed: 0.0001 m or more"}},
    {"ShapeThatReachesTooFar",
     "shapes: {it: {capsule: {radius: 1e6, height: 1e6}}}\n",
     {"scene.yaml:1:24: shapes.it.capsule: found a shape that reaches 1.5e+06 m from its origin, allowed: 1e+06 m"}},
};

class BadScene : public testing::TestWithParam<BadCase> {};

TEST_P(BadScene, IsRefusedWithPlaceFieldAndReason) {
  const Workspace workspace;
  expect_errors(workspace.scene_errors(GetParam().text), GetParam().errors);
}

INSTANTIATE_TEST_SUITE_P(All, BadScene, testing::ValuesIn(kBadScenes),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(BadSceneFile, LayoutLaunchNeedsALaunchFile) {
  const Workspace workspace;
  const auto file = workspace.write("scene.yaml", "layout: launch\n");
  expect_errors(workspace.errors_of([&] { read_scene(file); }),
                {"scene.yaml:1:9: layout: found \"launch\", allowed: a layout of its own"});
}

TEST(BadSceneFile, AGeneratorOfAPrototypeWithoutAShapeIsNoFurtherError) {
  const Workspace workspace;
  expect_errors(
      workspace.scene_errors("prototypes: {a: {shape: b, mass: 1}}\ngenerators: [{stack: {prototype: a, count: 2}}]\n"),
      {"scene.yaml:1:25: prototypes.a.shape: found \"b\""});
}

TEST(BadSceneFile, AShapeThatCannotBeReadIsOneErrorAndNotOneForEachUse) {
  const Workspace workspace;
  const std::string text =
      "shapes: {ball: {sphere: {radius: -1}}}\nprototypes: {a: {shape: ball, mass: 1}, b: {shape: ball, mass: 1}}\n";
  expect_errors(workspace.scene_errors(text), {"scene.yaml:1:34: shapes.ball.sphere.radius"});
}

}  // namespace
}  // namespace aurasim::config
