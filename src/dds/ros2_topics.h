// How ROS 2 names topics and types on the wire, and the hashes by which it distinguishes types (docs/ros2.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aurasim::dds {

/// A message of ROS, as idl/ros2.idl has it.
struct Ros2Type {
  std::string_view name;      ///< "rosgraph_msgs/msg/Clock"
  std::string_view dds_name;  ///< "rosgraph_msgs::msg::dds_::Clock_"
  std::string_view hash;      ///< "RIHS01_" and the SHA-256 of its description (REP-2016)
};

inline constexpr Ros2Type kRos2Clock{"rosgraph_msgs/msg/Clock", "rosgraph_msgs::msg::dds_::Clock_",
                                     "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"};
inline constexpr Ros2Type kRos2Tf{"tf2_msgs/msg/TFMessage", "tf2_msgs::msg::dds_::TFMessage_",
                                  "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
inline constexpr Ros2Type kRos2JointState{"sensor_msgs/msg/JointState", "sensor_msgs::msg::dds_::JointState_",
                                          "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"};
inline constexpr Ros2Type kRos2Twist{"geometry_msgs/msg/Twist", "geometry_msgs::msg::dds_::Twist_",
                                     "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"};

/// Name on the wire of a topic's full name: "/clock" becomes "rt/clock".
std::string ros2_wire_name(std::string_view topic);
/// Name of a body's command topic: "/NAME/cmd_vel".
std::string ros2_cmd_vel_topic(std::string_view body);
/// User data of an endpoint of this type, as ROS 2 expects it since Iron: "typehash=RIHS01_...;".
std::vector<unsigned char> ros2_user_data(const Ros2Type& type);

}  // namespace aurasim::dds
