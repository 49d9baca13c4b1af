#include "import/urdf_check.h"

#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "import/couplings.h"
#include "import/xml_file.h"

namespace aurasim::importing {
namespace {

using tinyxml2::XMLElement;

const std::set<std::string> kJointTypes = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};

std::vector<const XMLElement*> children(const XMLElement& parent, const char* name) {
  std::vector<const XMLElement*> found;
  for (const XMLElement* e = parent.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name))
    found.push_back(e);
  return found;
}

std::string text_of(const XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  return text == nullptr ? "" : text;
}

/// Returns attribute `attribute` of the child `child`.
std::string text_of(const XMLElement& element, const char* child, const char* attribute) {
  const XMLElement* below = element.FirstChildElement(child);
  return below == nullptr ? "" : text_of(*below, attribute);
}

/// Parses all numbers of a text; nothing if it contains anything else.
std::optional<std::vector<double>> numbers_in(const std::string& text) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double number = 0; in >> number;) numbers.push_back(number);
  if (!in.eof()) return std::nullopt;
  return numbers;
}

class UrdfCheck {
 public:
  UrdfCheck(std::string file, const XMLElement& robot) : file_(std::move(file)), robot_(robot) {}

  std::vector<std::string> run() {
    if (text_of(robot_, "name").empty()) complain(robot_, "robot", "it has no name");
    for (const XMLElement* link : children(robot_, "link")) check_link(*link);
    for (const XMLElement* joint : children(robot_, "joint")) check_joint(*joint);
    if (errors_.empty()) check_tree();
    return std::move(errors_);
  }

 private:
  void complain(const XMLElement& where, const std::string& element, const std::string& what) {
    errors_.push_back(fmt::format("{}:{}: {}: {}", file_, where.GetLineNum(), element, what));
  }

  /// Reads the numbers in an attribute. Nothing if it is missing or wrong; the latter adds an error.
  std::optional<std::vector<double>> numbers(const XMLElement& element, const char* attribute, std::size_t count,
                                             const std::string& name) {
    if (element.Attribute(attribute) == nullptr) return std::nullopt;
    auto found = numbers_in(element.Attribute(attribute));
    if (found && found->size() == count) return found;
    complain(
        element, fmt::format("{}/{}", name, attribute),
        fmt::format("found \"{}\", allowed: {} number{}", element.Attribute(attribute), count, count > 1 ? "s" : ""));
    return std::nullopt;
  }

  void check_origin(const XMLElement& of, const std::string& name) {
    const XMLElement* origin = of.FirstChildElement("origin");
    if (origin == nullptr) return;
    numbers(*origin, "xyz", 3, name + "/origin");
    numbers(*origin, "rpy", 3, name + "/origin");
  }

  void check_link(const XMLElement& link) {
    const std::string name = element_name("link", text_of(link, "name"));
    if (text_of(link, "name").empty()) complain(link, "link", "it has no name");
    if (!links_.insert(text_of(link, "name")).second) complain(link, name, "its name is there twice");
    if (const XMLElement* inertial = link.FirstChildElement("inertial")) check_inertial(*inertial, name + "/inertial");
    for (const XMLElement* collision : children(link, "collision")) {
      check_origin(*collision, name + "/collision");
      check_geometry(*collision, name + "/collision/geometry");
    }
  }

  void check_inertial(const XMLElement& inertial, const std::string& name) {
    check_origin(inertial, name);
    const XMLElement* mass = inertial.FirstChildElement("mass");
    if (mass == nullptr || mass->Attribute("value") == nullptr) {
      complain(inertial, name + "/mass", "it is missing");
    } else if (const auto value = numbers(*mass, "value", 1, name + "/mass"); value && (*value)[0] < 0) {
      complain(*mass, name + "/mass", fmt::format("found {}, allowed: 0 or more", (*value)[0]));
    }
    const XMLElement* inertia = inertial.FirstChildElement("inertia");
    if (inertia == nullptr) return complain(inertial, name + "/inertia", "it is missing");
    for (const char* key : {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"}) {
      if (inertia->Attribute(key) == nullptr)
        complain(*inertia, fmt::format("{}/inertia/{}", name, key), "it is missing");
      numbers(*inertia, key, 1, name + "/inertia");
    }
  }

  void check_sizes(const XMLElement& shape, const char* attribute, std::size_t count, const std::string& name) {
    if (shape.Attribute(attribute) == nullptr) return complain(shape, name + "/" + attribute, "it is missing");
    const auto sizes = numbers(shape, attribute, count, name);
    for (const double size : sizes.value_or(std::vector<double>{})) {
      if (!(size > 0)) complain(shape, name + "/" + attribute, fmt::format("found {}, allowed: above 0", size));
    }
  }

  void check_geometry(const XMLElement& collision, const std::string& name) {
    const XMLElement* geometry = collision.FirstChildElement("geometry");
    const XMLElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (shape == nullptr) return complain(collision, name, "it is missing or empty");
    const std::string kind = shape->Name();
    if (kind == "box") return check_sizes(*shape, "size", 3, name + "/box");
    if (kind == "sphere") return check_sizes(*shape, "radius", 1, name + "/sphere");
    if (kind == "cylinder") {
      check_sizes(*shape, "radius", 1, name + "/cylinder");
      return check_sizes(*shape, "length", 1, name + "/cylinder");
    }
    if (kind == "mesh") {
      if (text_of(*shape, "filename").empty()) complain(*shape, name + "/mesh/filename", "it is missing");
      return;
    }
    complain(*shape, name, fmt::format("found <{}>, allowed: box, sphere, cylinder, mesh", kind));
  }

  void check_joint(const XMLElement& joint) {
    const std::string name = element_name("joint", text_of(joint, "name")), type = text_of(joint, "type");
    if (text_of(joint, "name").empty()) complain(joint, "joint", "it has no name");
    if (!joints_.insert(text_of(joint, "name")).second) complain(joint, name, "its name is there twice");
    if (!kJointTypes.contains(type)) {
      complain(joint, name + "/type",
               fmt::format("found \"{}\", allowed: revolute, continuous, prismatic, fixed, floating, planar", type));
    }
    for (const char* end : {"parent", "child"}) {
      const std::string link = text_of(joint, end, "link");
      if (!links_.contains(link))
        complain(joint, fmt::format("{}/{}", name, end), fmt::format("there is no link \"{}\"", link));
    }
    const std::string child = text_of(joint, "child", "link");
    if (!parent_.try_emplace(child, text_of(joint, "parent", "link")).second)
      complain(joint, name + "/child", fmt::format("link \"{}\" has two parents; URDF knows trees only", child));
    check_origin(joint, name);
    check_axis(joint, name);
    if (type == "revolute" || type == "prismatic") check_limit(joint, name);
  }

  void check_axis(const XMLElement& joint, const std::string& name) {
    const XMLElement* axis = joint.FirstChildElement("axis");
    if (axis == nullptr) return;
    const auto xyz = numbers(*axis, "xyz", 3, name + "/axis");
    if (xyz && (*xyz)[0] == 0 && (*xyz)[1] == 0 && (*xyz)[2] == 0) complain(*axis, name + "/axis", "it has no length");
  }

  void check_limit(const XMLElement& joint, const std::string& name) {
    const XMLElement* limit = joint.FirstChildElement("limit");
    if (limit == nullptr) return complain(joint, name + "/limit", "it is missing");
    for (const char* key : {"effort", "velocity"}) {
      if (limit->Attribute(key) == nullptr) complain(*limit, fmt::format("{}/limit/{}", name, key), "it is missing");
      numbers(*limit, key, 1, name + "/limit");
    }
    const double low = numbers(*limit, "lower", 1, name + "/limit").value_or(std::vector<double>{0})[0];
    const double high = numbers(*limit, "upper", 1, name + "/limit").value_or(std::vector<double>{0})[0];
    if (low > high) complain(*limit, name + "/limit", fmt::format("lower {} is above upper {}", low, high));
  }

  /// Checks that there is exactly one link without a parent, and that all others descend from it.
  void check_tree() {
    std::set<std::string> roots;
    for (const std::string& link : links_) {
      if (!parent_.contains(link)) roots.insert(link);
    }
    if (roots.size() != 1)
      complain(robot_, "robot", fmt::format("found {} links without a parent, allowed: 1", roots.size()));
    for (const std::string& link : links_) {
      std::size_t steps = 0;
      for (auto at = parent_.find(link); at != parent_.end() && steps <= links_.size(); ++steps)
        at = parent_.find(at->second);
      if (steps > links_.size()) return complain(robot_, element_name("link", link), "it hangs from itself");
    }
  }

  std::string file_;
  const XMLElement& robot_;
  std::vector<std::string> errors_;
  std::set<std::string> links_, joints_;
  std::map<std::string, std::string> parent_;  ///< parent of each link
};

const XMLElement& load_robot(const std::filesystem::path& file, tinyxml2::XMLDocument& document) {
  const XMLElement* robot = load_xml(file, document);
  if (robot == nullptr) throw BadModel({fmt::format("{}: it has no element", file.string())});
  return *robot;
}

void read_mimic(const XMLElement& joint, const XMLElement& mimic, Model& model) {
  const std::string name = text_of(joint, "name"), leader = text_of(mimic, "joint");
  const std::string element = element_name("joint", name) + "/mimic";
  const auto here = find_joint(model, name), there = find_joint(model, leader);
  const auto lose = [&](std::string_view why) {
    model.lose(element, fmt::format("it follows joint '{}' ({}); in a scene it moves on its own", leader, why));
  };
  if (!here || !there) return lose("one of them is left out");
  const double ratio = mimic.DoubleAttribute("multiplier", 1), offset = mimic.DoubleAttribute("offset", 0);
  if (const std::string why = follow(*here, *there, ratio, offset, model); !why.empty()) return lose(why);
  model.note(element, fmt::format("what holds it back does not hold back joint '{}'", leader));
}

void tell_of_urdf_joint(const XMLElement& joint, Model& model) {
  const std::string name = element_name("joint", text_of(joint, "name"));
  if (const XMLElement* mimic = joint.FirstChildElement("mimic")) read_mimic(joint, *mimic, model);
  if (text_of(joint, "type") == "planar") model.lose(name, "a planar joint: it is left out");
  if (joint.FirstChildElement("safety_controller") != nullptr)
    model.note(name + "/safety_controller", "a bound for a controller");
  if (joint.FirstChildElement("calibration") != nullptr) model.note(name + "/calibration", "for a controller");
}

}  // namespace

void check_urdf(const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  const XMLElement& robot = load_robot(file, document);
  std::vector<std::string> errors = UrdfCheck(file.string(), robot).run();
  if (!errors.empty()) throw BadModel(std::move(errors));
}

void tell_of_urdf(const std::filesystem::path& file, Model& model) {
  tinyxml2::XMLDocument document;
  const XMLElement& robot = load_robot(file, document);
  std::set<std::string> there, lumped;
  for (const Link& link : model.links) there.insert(link.name);
  for (const XMLElement* joint : children(robot, "joint")) {
    tell_of_urdf_joint(*joint, model);
    if (text_of(*joint, "type") == "fixed") lumped.insert(text_of(*joint, "child", "link"));
  }
  for (const XMLElement* link : children(robot, "link")) {
    const std::string name = text_of(*link, "name");
    if (!there.contains(name) && !lumped.contains(name) && name != "world")
      model.lose(element_name("link", name), "it, or what it hangs from, has no mass: it is left out");
  }
  for (const XMLElement* transmission : children(robot, "transmission"))
    model.note(element_name("transmission", text_of(*transmission, "name")), "for a controller");
}

}  // namespace aurasim::importing
