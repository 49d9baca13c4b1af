#include "dds/ros2_topics.h"

#include <fmt/format.h>

namespace aurasim::dds {

std::string ros2_wire_name(std::string_view topic) { return fmt::format("rt{}", topic); }

std::string ros2_cmd_vel_topic(std::string_view body) { return fmt::format("/{}/cmd_vel", body); }

std::vector<unsigned char> ros2_user_data(const Ros2Type& type) {
  const std::string text = fmt::format("typehash={};", type.hash);
  return {text.begin(), text.end()};
}

}  // namespace aurasim::dds
