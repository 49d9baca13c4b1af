#include "overseer/run_command_sink.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/mesh_hash.h"

namespace aurasim::overseer {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using steering::BadAsk;

constexpr auto kPatienceForEffect = 10s;
constexpr auto kPatienceForSuccessor = 60s;
constexpr auto kPatienceForListeners = 3s;
/// A step may be asked for while the run still computes states before its pause.
constexpr core::Step kStatesOfASecond = 60;

nlohmann::json list(const core::Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json object_json(const std::optional<core::ObjectRef>& object) {
  nlohmann::json json = {{"body", nullptr}, {"static", nullptr}};
  if (object) json[*object >= 0 ? "body" : "static"] = *object >= 0 ? *object : -1 - *object;
  return json;
}

nlohmann::json result_of(const steering::Delivery& delivery) {
  nlohmann::json json = object_json(delivery.object);
  json["step"] = delivery.at_step;
  if (!delivery.is_ray) return json;
  json["hit"] = delivery.object.has_value();
  json["p"] = list(delivery.p_W);
  json["normal"] = list(delivery.normal_W);
  json["distance"] = delivery.object ? nlohmann::json(delivery.distance_m) : nlohmann::json(nullptr);
  json["complete"] = delivery.silent.empty();
  json["silent_regions"] = nlohmann::json::array();
  for (const core::RegionId region : delivery.silent) json["silent_regions"].push_back(core::value_of(region));
  return json;
}

}  // namespace

void RunCommandSink::submit(Request request) {
  if (const auto* steered = std::get_if<steering::Steer>(&request.ask.what)) return steer(request, *steered);
  if (const auto* drained = std::get_if<steering::Drain>(&request.ask.what)) return drain(request, drained->region);
  held_.push_back({std::move(request), Clock::now() + kPatienceForListeners});
  carry_held();
}

void RunCommandSink::carry_held() {
  if (held_.empty() || (!client_.all_listen() && Clock::now() < held_.front().deadline)) return;
  for (Held& held : std::exchange(held_, {})) {
    if (waits_for_parts(held.request)) {
      held_.push_back(std::move(held));
    } else {
      carry(held.request);
    }
  }
}

bool RunCommandSink::waits_for_parts(const Request& request) {
  const core::MeshRef* const ref = core::mesh_in(std::get<core::Ask>(request.ask.what));
  if (ref == nullptr || ref->use != core::MeshUse::kDecomposition) return false;
  const auto mesh = shapes_.find(ref->hash);
  return mesh != nullptr && part_finder_.parts_of(ref->hash, mesh) == nullptr;
}

/// Once they have been found. Throws BadAsk.
core::MeshRef RunCommandSink::parts_of(std::uint64_t hash, const std::shared_ptr<const core::TriangleMesh>& mesh) {
  if (mesh == nullptr) throw BadAsk("the mesh has to be sent to this overseer's /api/shapes first");
  const PartFinder::Parts& parts = *part_finder_.parts_of(hash, mesh);
  if (const auto* why = std::get_if<std::string>(&parts)) throw BadAsk(*why);
  const auto& pieces = std::get<core::TriangleMesh>(parts);
  const std::uint64_t hash_of_parts = core::content_hash(pieces);
  client_.bring(hash_of_parts, pieces);
  return {hash_of_parts, core::MeshUse::kDecomposition};
}

void RunCommandSink::refuse(const Request& request, std::string why) {
  replies_.push_back({request.client, request.id, false, std::move(why), nullptr});
}

void RunCommandSink::steer(const Request& request, const steering::Steer& steer) {
  if (!steering_.is_there()) return refuse(request, "no node of this run is there");
  if (steer.kind == messages::RunCommandKind::kStep && !steering_.is_paused_within(kStatesOfASecond)) {
    return refuse(request, "steps are for a run that is paused");
  }
  try {
    under_way_.push_back(
        {request.client, request.id, steering_.send(steer.kind, steer.count), Clock::now() + kPatienceForEffect});
  } catch (const std::runtime_error& error) {
    refuse(request, error.what());
  }
}

void RunCommandSink::drain(const Request& request, core::RegionId region) {
  try {
    leaving_.push_back({request.client, request.id, steering::Draining(control_, region), region,
                        Clock::now() + kPatienceForSuccessor});
  } catch (const std::runtime_error& error) {
    refuse(request, error.what());
  }
}

/// Sends the mesh that the ask names to the nodes, if this process has it; otherwise some other overseer has brought
/// it. Parts are brought under a hash of their own, once they have been found. Throws BadAsk.
void RunCommandSink::bring_mesh_of(core::Ask& ask) {
  core::MeshRef* const ref = core::mesh_in(ask);
  if (ref == nullptr) return;
  const auto mesh = shapes_.find(ref->hash);
  if (ref->use == core::MeshUse::kDecomposition) {
    *ref = parts_of(ref->hash, mesh);
  } else if (mesh) {
    client_.bring(ref->hash, *mesh);
  }
}

void RunCommandSink::carry(const Request& request) {
  try {
    if (!steering_.is_there()) throw BadAsk("no node of this run is there");
    steering::Ask ask = request.ask;
    steering::look_up_static(ask, launch_.scene);
    core::Command command;
    command.at_step = ask.at_step;
    command.ask = std::get<core::Ask>(std::move(ask.what));
    bring_mesh_of(command.ask);
    sent_[client_.send(std::move(command))] = {request.client, request.id};
  } catch (const std::runtime_error& error) {
    refuse(request, error.what());
  }
}

void RunCommandSink::reply_to_drains() {
  std::erase_if(leaving_, [this](Leaving& waiting) {
    const messages::Status* const successor = waiting.drain.successor();
    if (successor == nullptr && Clock::now() < waiting.deadline) return false;
    std::string text = successor != nullptr
                           ? fmt::format("process {} has taken region {} over by step {}", successor->pid,
                                         core::value_of(waiting.region), successor->step)
                           : steering::kNobodyTakesOver;
    replies_.push_back({waiting.client, waiting.request, successor != nullptr, std::move(text), nullptr});
    return true;
  });
}

std::vector<Reply> RunCommandSink::take_replies() {
  carry_held();
  reply_to_drains();
  for (const steering::Delivery& delivery : client_.take()) {
    const auto found = sent_.find(delivery.request);
    if (found == sent_.end()) continue;
    replies_.push_back(
        {found->second.client, found->second.request, delivery.done, delivery.text, result_of(delivery)});
    sent_.erase(found);
  }
  std::erase_if(under_way_, [this](const UnderWay& waiting) {
    const bool done = steering_.has_taken_effect(waiting.command);
    if (!done && Clock::now() < waiting.deadline) return false;
    const char* kind = messages::name_of(waiting.command.kind);
    std::string text = done ? fmt::format("{}: done at step {}", kind, waiting.command.at_step)
                            : fmt::format("{} was sent, but not every node shows its effect", kind);
    replies_.push_back({waiting.client, waiting.request, done, std::move(text), nullptr});
    return true;
  });
  return std::exchange(replies_, {});
}

}  // namespace aurasim::overseer
