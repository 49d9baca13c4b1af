// The messages of idl/ros2.idl are ROS's: their type hashes, worked out from that file by ROS's rule (REP-2016), are
// the ones that ROS publishes.
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <openssl/evp.h>

#include "dds/ros2_topics.h"

namespace aurasim::dds {
namespace {

struct Field {
  std::string name;
  int type_id = 0;
  std::string nested;  ///< "std_msgs/msg/Header"
};
/// By name, "std_msgs/msg/Header".
using Types = std::map<std::string, std::vector<Field>>;

// Numbers of type_description_interfaces/msg/FieldType.
constexpr int kNested = 1, kUnboundedSequence = 144;
const std::map<std::string, int> kTypeIds = {{"long", 6}, {"unsigned long", 7}, {"double", 11}, {"string", 17}};

/// "std_msgs::msg::dds_::Header_" as ROS calls it.
std::string ros_name(const std::string& dds_name) {
  const std::string name = std::regex_replace(dds_name, std::regex("::msg::dds_::(\\w+)_$"), "/msg/$1");
  EXPECT_NE(name, dds_name);
  return name;
}

Field field_of(std::string type, const std::string& name) {
  Field field;
  field.name = name.substr(0, name.size() - 1);
  EXPECT_EQ(name.back(), '_') << name;
  std::smatch of;
  if (std::regex_match(type, of, std::regex("sequence<(.*)>"))) {
    field.type_id = kUnboundedSequence;
    type = of[1];
  }
  const auto primitive = kTypeIds.find(type);
  field.type_id += primitive != kTypeIds.end() ? primitive->second : kNested;
  if (primitive == kTypeIds.end()) field.nested = ros_name(type);
  return field;
}

Types types_in_idl() {
  std::ifstream file(AURASIM_SOURCE_DIR "/idl/ros2.idl");
  std::string line, package, current;
  Types types;
  std::smatch found;
  while (std::getline(file, line)) {
    if (std::regex_search(line, found, std::regex("^module (\\w+) \\{ module msg \\{ module dds_ \\{"))) {
      package = found[1];
    } else if (std::regex_search(line, found, std::regex("^struct (\\w+)_ \\{"))) {
      current = fmt::format("{}/msg/{}", package, found[1].str());
      types[current];
    } else if (std::regex_search(line, found, std::regex("^  ([\\w:<> ]+) (\\w+);"))) {
      types[current].push_back(field_of(found[1], found[2]));
    }
  }
  return types;
}

std::string description(const std::string& name, const Types& types) {
  std::string fields;
  for (const Field& field : types.at(name)) {
    fields += fmt::format(
        R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": 0, "string_capacity": 0, "nested_type_name": "{}"}}}})",
        fields.empty() ? "" : ", ", field.name, field.type_id, field.nested);
  }
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", name, fields);
}

void add_nested(const std::string& name, const Types& types, std::set<std::string>& all) {
  for (const Field& field : types.at(name)) {
    if (!field.nested.empty() && all.insert(field.nested).second) add_nested(field.nested, types, all);
  }
}

std::string sha256(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), digest, &size, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned i = 0; i < size; ++i) hex += fmt::format("{:02x}", digest[i]);
  return hex;
}

std::string type_hash(const std::string& name, const Types& types) {
  std::set<std::string> nested;
  add_nested(name, types, nested);
  std::string referenced;
  for (const std::string& other : nested) {
    referenced += (referenced.empty() ? "" : ", ") + description(other, types);
  }
  return "RIHS01_" + sha256(fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})",
                                        description(name, types), referenced));
}

TEST(Ros2Types, HaveTheHashesOfRos) {
  const Types types = types_in_idl();
  EXPECT_EQ(types.size(), 10U);
  for (const Ros2Type& type : {kRos2Clock, kRos2Tf, kRos2JointState, kRos2Twist}) {
    EXPECT_EQ(type_hash(std::string(type.name), types), type.hash);
    EXPECT_EQ(ros_name(std::string(type.dds_name)), type.name);
  }
  // Published, and of no endpoint here.
  EXPECT_EQ(type_hash("std_msgs/msg/Header", types),
            "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
}

TEST(Ros2Types, AnotherMemberIsAnotherHash) {
  Types types = types_in_idl();
  types["builtin_interfaces/msg/Time"][1].name = "nanoseconds";
  EXPECT_NE(type_hash("rosgraph_msgs/msg/Clock", types), kRos2Clock.hash);
}

TEST(Ros2Types, NamesOnTheWireAreThoseOfRos) {
  EXPECT_EQ(ros2_wire_name("/clock"), "rt/clock");
  EXPECT_EQ(ros2_wire_name(ros2_cmd_vel_topic("robot")), "rt/robot/cmd_vel");
  const auto said = ros2_user_data(kRos2Clock);
  EXPECT_EQ(std::string(said.begin(), said.end()),
            "typehash=RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564;");
}

}  // namespace
}  // namespace aurasim::dds
