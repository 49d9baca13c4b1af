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
using Kind = dds::RunCommandKind;

constexpr auto kPatienceForEffect = 10s;
constexpr auto kPatienceForListeners = 3s;

class BadAsk : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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

void RunCommandSink::submit(overseer::Request request) {
  if (std::holds_alternative<overseer::Pause>(request.command)) {
    steer(request, Kind::kPause, 1);
  } else if (std::holds_alternative<overseer::Resume>(request.command)) {
    steer(request, Kind::kResume, 1);
  } else if (std::holds_alternative<overseer::Reset>(request.command)) {
    steer(request, Kind::kReset, 1);
  } else if (const auto* step = std::get_if<overseer::StepOn>(&request.command)) {
    steer(request, Kind::kStep, step->count);
  } else {
    held_.push_back({std::move(request), Clock::now() + kPatienceForListeners});
    carry_held();
  }
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

bool RunCommandSink::waits_for_parts(const overseer::Request& request) {
  const auto* const spawn = std::get_if<overseer::Spawn>(&request.command);
  const auto* const kind = spawn == nullptr ? nullptr : std::get_if<overseer::NewKind>(&spawn->kind);
  const auto* const stored = kind == nullptr ? nullptr : std::get_if<overseer::StoredShape>(&kind->shape);
  if (stored == nullptr || stored->as != overseer::StoredShape::As::kDecomposition) return false;
  const auto mesh = shapes_.find(stored->hash);
  return mesh != nullptr && part_finder_.parts_of(stored->hash, mesh) == nullptr;
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

void RunCommandSink::steer(const overseer::Request& request, Kind kind, std::int64_t count) {
  const auto refuse = [&](std::string why) {
    replies_.push_back({request.client, request.id, false, std::move(why), nullptr});
  };
  if (!steering_.is_there()) return refuse("no node of this run is there");
  if (kind == Kind::kStep && !steering_.is_paused()) return refuse("steps are for a run that is paused");
  try {
    under_way_.push_back({request.client, request.id, steering_.send(kind, count), Clock::now() + kPatienceForEffect});
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

/// Throws BadAsk.
core::ClientShape RunCommandSink::client_shape(const overseer::ShapeChoice& choice) {
  if (const auto* stored = std::get_if<overseer::StoredShape>(&choice)) {
    const auto mesh = shapes_.find(stored->hash);
    using As = overseer::StoredShape::As;
    if (stored->as == As::kDecomposition) return parts_of(stored->hash, mesh);
    if (mesh) client_.bring(stored->hash, *mesh);  // or some other overseer has brought it
    return core::MeshRef{stored->hash, stored->as == As::kMesh ? core::MeshUse::kTriangles : core::MeshUse::kHull};
  }
  return std::visit(
      [](const auto& shape) -> core::ClientShape {
        if constexpr (std::is_constructible_v<core::ClientShape, decltype(shape)>) {
          return shape;
        } else {
          throw BadAsk("a shape of this kind has to be sent to /api/shapes as a mesh");
        }
      },
      std::get<core::Shape>(choice));
}

core::Ask RunCommandSink::ask_for(const overseer::Command& command) {
  if (const auto* c = std::get_if<overseer::Spawn>(&command)) {
    core::NewBody body;
    body.pose = c->pose;
    body.v_WB = c->v_WB;
    body.w_WB = c->w_WB;
    if (const auto* name = std::get_if<std::string>(&c->kind)) {
      body.prototype = *name;
    } else {
      const auto& kind = std::get<overseer::NewKind>(c->kind);
      body.shape = client_shape(kind.shape);
      body.mass_kg = kind.mass_kg;
    }
    return body;
  }
  if (const auto* c = std::get_if<overseer::PlaceStatic>(&command)) {
    return core::NewStatic{client_shape(c->shape), c->pose};
  }
  if (const auto* c = std::get_if<overseer::Remove>(&command)) {
    if (const auto* body = std::get_if<core::BodyId>(&c->what)) return core::RemoveBody{*body};
    return core::RemoveStatic{std::get<core::StaticId>(c->what)};
  }
  if (const auto* c = std::get_if<overseer::Impulse>(&command)) return core::Impulse{c->body, c->J_W, c->p_W};
  if (const auto* c = std::get_if<overseer::SetVelocity>(&command)) {
    return core::SetVelocity{c->body, c->v_WB, c->w_WB};
  }
  if (const auto* c = std::get_if<overseer::SetRate>(&command)) return core::SetRate{c->value};
  if (const auto* c = std::get_if<overseer::SetRegions>(&command)) return core::Repartition{c->boxes};
  if (const auto* c = std::get_if<overseer::LoadScene>(&command)) return core::ChangeScene{c->name};
  if (const auto* c = std::get_if<overseer::SaveWorld>(&command)) return core::Save{c->name};
  if (const auto* c = std::get_if<overseer::LoadWorld>(&command)) return core::Load{c->name};
  if (std::holds_alternative<overseer::StepBack>(command)) return core::Load{};
  if (const auto* c = std::get_if<overseer::CastRay>(&command)) return core::Ray{c->from, c->to, c->regions};
  throw BadAsk("not supported by this run");
}

void RunCommandSink::carry(const overseer::Request& request) {
  try {
    if (!steering_.is_there()) throw BadAsk("no node of this run is there");
    core::Command command;
    command.ask = ask_for(request.command);
    sent_[client_.send(std::move(command))] = {request.client, request.id};
  } catch (const std::runtime_error& error) {
    replies_.push_back({request.client, request.id, false, error.what(), nullptr});
  }
}

std::vector<overseer::Reply> RunCommandSink::take_replies() {
  carry_held();
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
    const char* kind = dds::name_of(waiting.command.kind);
    std::string text = done ? fmt::format("{}: done at step {}", kind, waiting.command.at_step)
                            : fmt::format("{} was sent, but not every node shows its effect", kind);
    replies_.push_back({waiting.client, waiting.request, done, std::move(text), nullptr});
    return true;
  });
  return std::exchange(replies_, {});
}

}  // namespace aurasim::overseer
