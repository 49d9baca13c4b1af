// Files that are wrong: refused, with file and element.
#include "import/imported.h"

namespace aurasim::importing {
namespace {

struct BrokenCase {
  const char* name;
  const char* file;
  std::string text;
  std::vector<std::string> said;  ///< all of it stands in one of the errors
};

void PrintTo(const BrokenCase& broken, std::ostream* out) { *out << broken.name; }

const std::string kBox = "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>";
const std::string kMass =
    "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";

std::string urdf(const std::string& inside) { return "<robot name=\"r\">\n" + inside + "\n</robot>\n"; }
std::string sdf(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"><model name=\"m\">\n" + inside + "\n</model></sdf>\n";
}
std::string link(const std::string& name) { return "<link name=\"" + name + "\">" + kMass + kBox + "</link>\n"; }
std::string joint(const std::string& inside) { return "<joint name=\"j\" type=\"revolute\">" + inside + "</joint>"; }

const std::vector<BrokenCase> kBroken = {
    {"NoXml", "a.urdf", "<robot name='r'><link", {"a.urdf:1", "no XML"}},
    {"AnotherFormat", "a.xml", "<scene/>", {"a.xml", "<scene>", "robot (URDF), sdf, mujoco (MJCF)"}},
    {"UrdfTwoOfAName", "a.urdf", urdf(link("a") + link("a")), {"a.urdf:3", "link 'a'", "twice"}},
    {"UrdfNoSuchParent",
     "a.urdf",
     urdf(link("a") + joint("<parent link=\"x\"/><child link=\"a\"/><limit effort=\"1\" velocity=\"1\"/>")),
     {"a.urdf:3", "joint 'j'/parent", "\"x\""}},
    {"UrdfNoLimit",
     "a.urdf",
     urdf(link("a") + link("b") + joint("<parent link=\"a\"/><child link=\"b\"/>")),
     {"a.urdf:4", "joint 'j'/limit", "missing"}},
    {"UrdfNoNumber",
     "a.urdf",
     urdf("<link name=\"a\"><collision><origin xyz=\"0 zero 0\"/><geometry><sphere "
          "radius=\"1\"/></geometry></collision></link>"),
     {"a.urdf:2", "link 'a'/collision/origin/xyz", "0 zero 0"}},
    {"UrdfSizeBelowZero",
     "a.urdf",
     urdf("<link name=\"a\">" + kMass + "<collision><geometry><box size=\"1 -1 1\"/></geometry></collision></link>"),
     {"link 'a'/collision/geometry/box/size", "found -1"}},
    {"UrdfTwoRoots", "a.urdf", urdf(link("a") + link("b")), {"a.urdf", "robot", "2 links without a parent"}},
    {"UrdfMeshOutside",
     "a.urdf",
     urdf("<link name=\"a\">" + kMass +
          "<collision><geometry><mesh filename=\"/etc/passwd\"/></geometry></collision></link>"),
     {"a.urdf", "link 'a'/collision", "/etc/passwd"}},
    {"SdfNoSuchChild",
     "a.sdf",
     sdf("<link name=\"a\"/><joint name=\"j\" type=\"ball\"><parent>a</parent><child>nobody</child></joint>"),
     {"a.sdf", "nobody"}},
    {"SdfNoSuchFrame", "a.sdf", sdf("<link name=\"a\"><pose relative_to=\"nowhere\"/></link>"), {"a.sdf", "nowhere"}},
    {"SdfMassOfNothing", "a.sdf", sdf("<link name=\"a\"><inertial><mass>-1</mass></inertial></link>"), {"a.sdf", "a"}},
    {"SdfImpossibleInertia",
     "a.sdf",
     sdf("<link "
         "name=\"a\"><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>9</izz></inertia></inertial></"
         "link>"),
     {"a.sdf", "link named a", "inertia"}},
    {"SdfNoMesh",
     "a.sdf",
     sdf("<link name=\"a\"><collision "
         "name=\"c\"><geometry><mesh><uri>model://no/such.obj</uri></mesh></geometry></collision></link>"),
     {"a.sdf", "link 'a'/collision 'c'", "model://no/such.obj"}},
    {"SdfIncludesItself",
     "a.sdf",
     "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\"><model "
     "name=\"m\"><include><uri>a.sdf</uri></include></model></sdf>",
     {"a.sdf", "<include>", "includes itself"}},
    {"MjcfUnknownElement",
     "a.xml",
     "<mujoco>\n<worldbody>\n<boody/>\n</worldbody>\n</mujoco>",
     {"a.xml", "boody", "line 3"}},
    {"MjcfNoMass",
     "a.xml",
     "<mujoco><worldbody><body name=\"b\"><freejoint/></body></worldbody></mujoco>",
     {"a.xml", "mass", "b"}},
    {"MjcfNoSuchBody",
     "a.xml",
     "<mujoco><worldbody><geom size=\"1\"/></worldbody><equality><weld body1=\"x\" body2=\"y\"/></equality></mujoco>",
     {"a.xml", "x"}},
    {"MjcfMeshOutside",
     "a.xml",
     "<mujoco>\n<asset><mesh name=\"m\" file=\"../../etc/m.stl\"/></asset></mujoco>",
     {"a.xml:2", "<mesh>/file", "../../etc/m.stl"}},
    {"MeshWithoutTriangles", "a.obj", "v 0 0 0\n", {"a.obj"}},
};

class Broken : public ::testing::TestWithParam<BrokenCase> {};

TEST_P(Broken, IsRefusedWithFileAndElement) {
  const config::Workspace workspace;
  const std::filesystem::path file = workspace.write(GetParam().file, GetParam().text);
  try {
    read_model(file, {});
    FAIL() << "it was read";
  } catch (const BadModel& bad) {
    for (const std::string& part : GetParam().said) EXPECT_THAT(bad.what(), ::testing::HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Broken, ::testing::ValuesIn(kBroken), [](const auto& info) { return info.param.name; });

TEST(BrokenFiles, AMissingFileIsNamed) {
  EXPECT_THROW(
      {
        try {
          read_model("/nowhere/robot.urdf", {});
        } catch (const BadModel& bad) {
          EXPECT_STREQ(bad.what(), "/nowhere/robot.urdf: no such file");
          throw;
        }
      },
      BadModel);
}

}  // namespace
}  // namespace aurasim::importing
