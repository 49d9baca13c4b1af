// One state of the whole world as a difference to the one before: what the view hands to the web server.
#pragma once

#include <cstdint>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"

namespace aurasim::overseer {

/// Small number by which pages know a body. Reused in a later frame after the body is gone.
using Slot = std::uint32_t;

struct ViewBody {
  Slot slot = 0;
  core::BodyId id{};
  core::Epoch epoch = 0;
  core::RegionId host{};
  core::PrototypeId prototype{};
  bool asleep = false;
  bool under_way = false;  ///< its last host has handed it to `host`, which has not published it yet
  core::Vec3 p_WB = core::Vec3::Zero();
  Eigen::Quaternionf q_WB = Eigen::Quaternionf::Identity();
  Eigen::Vector3f v_WB = Eigen::Vector3f::Zero();
  Eigen::Vector3f w_WB = Eigen::Vector3f::Zero();
};

struct BodyChange {
  ViewBody body;
  bool created = false;
  bool host_changed = false;  ///< host, epoch, asleep or under_way changed
  bool moved = false;
  bool handed_over = false;  ///< a new host has the body now
};

struct WorldFrame {
  core::Generation generation = 0;
  core::Step stamp = 0;
  bool restart = false;       ///< forget every body first
  std::vector<Slot> deleted;  ///< slots whose bodies are gone; applied before `changed`
  std::vector<BodyChange> changed;
};

}  // namespace aurasim::overseer
