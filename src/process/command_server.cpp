#include "process/command_server.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/meshes.h"
#include "core/static_moves.h"
#include "cut/saved_world.h"
#include "messages/status_period.h"
#include "node/scene_additions.h"
#include "steering/ask.h"
#include "steering/command_limits.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatienceForMesh = 15s;
constexpr auto kLongestUnanswered = 2s;
constexpr double kLongestShown_s = 0.5;  ///< no observer shows older states
constexpr int kStatusesOfAll = 3;  ///< status periods after a command in which every node says which meshes it has
constexpr std::size_t kMostInAState = 300;  ///< commands that become orders in one state, at most
constexpr std::size_t kTextWeighs = 20;
/// Limits of the clients' meshes that a node keeps.
constexpr dds::MeshCacheLimits kMeshes{512, std::size_t{128} << 20U, 128, std::size_t{32} << 20U};

/// The mesh by which an order defines a shape. Null if it defines none.
const core::MeshRef* mesh_defined_by(const core::Order& order) {
  const auto* const defined = std::get_if<core::DefineShape>(&order.action);
  return defined == nullptr ? nullptr : std::get_if<core::MeshRef>(&defined->shape);
}

}  // namespace

CommandServer::CommandServer(const config::Launch& launch, dds::Participant& participant, core::RegionId region,
                             std::filesystem::path saves)
    : launch_(launch),
      region_(region),
      saves_(std::move(saves)),
      endpoint_(participant, region, launch.regions.version()),
      issuer_(launch),
      mesh_reader_(participant, kMeshes),
      participant_(participant),
      additions_writer_(participant, region) {}

void CommandServer::begin_generation(node::Node& node, core::Generation generation) {
  not_kept_.clear();
  reply_all_done(0);
  take_over(node, generation);
}

void CommandServer::take_over(node::Node& node, core::Generation generation) {
  for (Taken& one : taken_) one.went_back = true;
  change_at_.reset();
  additions_ = {generation, {}};
  issuer_.begin_generation();
  mesh_reader_.meshes().release_all();
  node.use_meshes([this](const core::MeshRef& mesh) {
    std::optional<core::Shape> shape = make_mesh(mesh);
    mesh_reader_.meshes().release(mesh.hash);
    return shape;
  });
}

void CommandServer::change_map(core::Generation generation, core::Step step) {
  endpoint_.use_map(launch_.regions.version());
  additions_.generation = generation;
  change_at_.reset();
  reply_all_done(step);
  if (leads_) send_additions();
  issuer_.reopen();
}

void CommandServer::serve(node::Node& node, const RunView& run) {
  reply_accepted(node, run);
  // A new lead publishes the additions of a saved world to observers.
  if (!std::exchange(leads_, run.leads) && leads_ && !additions_.orders.empty()) send_additions();
  dds::MeshCache& meshes = mesh_reader_.meshes();  // takes in all meshes, for the lead's account of them
  std::vector<Asked> asked = std::exchange(waiting_for_mesh_, {});
  for (core::Command& command : endpoint_.take()) asked.push_back({std::move(command), Clock::now()});
  for (Asked& one : asked) {
    const core::MeshRef* const mesh = core::mesh_in(one.command.ask);
    if (mesh != nullptr) meshes.retain(mesh->hash);
    if (const auto* ray = std::get_if<core::Ray>(&one.command.ask)) {
      answer(one.command, *ray, node);
    } else if (comes_after_the_pause(one.command, node, run)) {
      save_as_it_stands(one.command, std::get<core::Save>(one.command.ask), node, run);
    } else if (!run.leads) {
      endpoint_.forget(one.command.request);  // the next lead may have to execute it
    } else if (const auto* rate = std::get_if<core::SetRate>(&one.command.ask)) {
      take_rate(one.command, *rate, node);
    } else if (mesh != nullptr && !is_everywhere(mesh->hash, one, run)) {
      wait_for_mesh(std::move(one), *mesh, run);
    } else {
      decide(one.command, node, run);
    }
  }
}

void CommandServer::answer(const core::Command& command, const core::Ray& ray, const node::Node& node) {
  const bool asked = ray.regions.empty() || std::ranges::find(ray.regions, region_) != ray.regions.end();
  if (!asked) return;
  if (std::string why = steering::problem_with(core::Ask(ray)); !why.empty())
    return refuse(command.request, std::move(why));
  const physics::RayHit hit = node.world().cast(ray.from_W, ray.to_W);
  core::CommandReply seen;
  seen.request = command.request;
  seen.outcome = core::Outcome::kSeen;
  seen.at_step = node.current_step();
  seen.object = hit.object;
  seen.p_W = hit.p_W;
  seen.normal_W = hit.normal_W;
  seen.distance_m = hit.distance_m;
  endpoint_.reply(std::move(seen));
}

/// Takes a request for another rate. It concerns the clocks only, so no order is made: the process applies it at once
/// (take_wanted_rate).
void CommandServer::take_rate(const core::Command& command, const core::SetRate& ask, const node::Node& node) {
  const steering::CommandContext context{launch_, node.scene(), node.current_step(), 0, std::nullopt};
  if (std::string why = steering::problem_with(command, context); !why.empty())
    return refuse(command.request, std::move(why));
  wanted_rate_ = ask.rate;
  reply_done(command.request, node.current_step());
}

/// True if every live node has published, since the command came, that it has this mesh.
bool CommandServer::is_everywhere(std::uint64_t hash, const Asked& asked, const RunView& run) {
  const auto until_all_say = kStatusesOfAll * messages::status_period(launch_.regions.size());
  return Clock::now() >= asked.since + until_all_say && mesh_reader_.mesh(hash) != nullptr && run.lacking(hash).empty();
}

/// Waits until a mesh has reached all nodes, and refuses the command after some seconds.
void CommandServer::wait_for_mesh(Asked asked, const core::MeshRef& mesh, const RunView& run) {
  if (Clock::now() < asked.since + kPatienceForMesh) {
    waiting_for_mesh_.push_back(std::move(asked));
    return;
  }
  std::vector<std::uint32_t> lacking;
  for (const core::RegionId region : run.lacking(mesh.hash)) lacking.push_back(core::value_of(region));
  if (mesh_reader_.mesh(mesh.hash) == nullptr && std::ranges::find(lacking, core::value_of(region_)) == lacking.end()) {
    lacking.push_back(core::value_of(region_));
  }
  refuse(asked.command.request,
         fmt::format(
             "after {} s the nodes of regions [{}] have not received the mesh: send it to /api/shapes first. A node "
             "keeps {} meshes and {} MiB of one client",
             kPatienceForMesh.count(), fmt::join(lacking, ", "), kMeshes.meshes_of_source,
             kMeshes.bytes_of_source >> 20U));
}

void CommandServer::refuse(std::uint64_t request, std::string why) {
  core::CommandReply reply;
  reply.request = request;
  reply.outcome = core::Outcome::kRefused;
  reply.text = std::move(why);
  endpoint_.reply(std::move(reply));
}

/// True for a save in a pause whose state comes after the pause, or is not confirmed before the run goes on.
bool CommandServer::comes_after_the_pause(const core::Command& command, const node::Node& node,
                                          const RunView& run) const {
  if (!run.holds_at || !std::holds_alternative<core::Save>(command.ask) || command.at_step > *run.holds_at) {
    return false;
  }
  const core::Step until_certain = node.current_step() - node.confirmed_step();
  return std::max(command.at_step, node.protocol().earliest_effect()) + until_certain > *run.holds_at;
}

/// Saves a world in a pause. The lead replies with the state, and the client repeats its request with that state for
/// the other nodes. Nodes that are not paused yet receive a repetition later. In state 0 no state has to be named,
/// because there is no other.
void CommandServer::save_as_it_stands(const core::Command& command, const core::Save& ask, const node::Node& node,
                                      const RunView& run) {
  const core::Step now = node.current_step();
  if (now < *run.holds_at || (!run.leads && command.at_step != now)) return endpoint_.forget(command.request);
  if (std::string why = steering::problem_with(core::Ask(ask)); !why.empty()) {
    return refuse(command.request, std::move(why));
  }
  standing_saves_.push_back({command.request, now, ask.file});
  if (!run.leads) return;
  core::CommandReply reply;
  reply.request = command.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = now;
  reply.text = core::kSavedAsItStands;
  endpoint_.reply(std::move(reply));
}

void CommandServer::go_back_to(const core::Command& back, core::Step step) {
  core::CommandReply reply;
  reply.request = back.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = step;
  endpoint_.reply(std::move(reply));
  due_[back.request] = {step, std::nullopt};
}

void CommandServer::load_instead(core::Command back, std::string file, node::Node& node, const RunView& run) {
  back.ask = core::Load{std::move(file)};
  decide(back, node, run);
}

/// Why a saved world cannot be loaded; empty if it can. Checked before all nodes stop for it.
std::string CommandServer::problem_with_world(const core::Ask& ask) const {
  const auto* const load = std::get_if<core::Load>(&ask);
  if (load == nullptr || !cut::is_save_name(load->file)) return {};
  try {
    cut::load_world({(saves_ / load->file).string(), false}, launch_);
    return {};
  } catch (const config::BadConfig& bad) {
    return bad.errors().front();
  }
}

void CommandServer::decide(const core::Command& command, node::Node& node, const RunView& run) {
  // One batch takes all orders of a state, and a batch that is too long is refused as a whole.
  if (std::exchange(decided_at_, node.current_step()) != node.current_step()) decided_ = 0;
  const bool has_text = std::holds_alternative<core::Save>(command.ask);
  decided_ += has_text ? kTextWeighs : 1;
  if (decided_ > kMostInAState) {
    return refuse(command.request, fmt::format("too many commands in state {}: send this one again in the next state",
                                               node.current_step()));
  }
  if (const auto* load = std::get_if<core::Load>(&command.ask); load != nullptr && load->file.empty()) {
    wanted_back_ = command;
    return;
  }
  if (std::string why = problem_with_world(command.ask); !why.empty()) return refuse(command.request, std::move(why));
  if (const core::Order* const known = node.ordered(command.request)) return reply_again(*known, node);
  const core::Step known_at = node.protocol().earliest_effect();
  Issued issued = issuer_.issue(
      command, run.facts, [this](const core::MeshRef& mesh) { return make_mesh(mesh); }, node);
  if (!issued.order) return refuse(command.request, std::move(issued.refused));
  core::CommandReply reply;
  reply.request = command.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = issued.order->at_step;
  reply.object = issued.object;
  if (command.at_step > 0) {
    taken_.push_back({known_at, Clock::now(), false, std::move(reply)});
  } else {
    endpoint_.reply(std::move(reply));
  }
  const core::Action& action = issued.order->action;
  const bool all_reply = std::holds_alternative<core::Save>(action);
  if (all_reply || core::changes_the_run(action)) not_kept_.push_back(command.request);
  if (core::changes_the_run(action)) change_at_ = issued.order->at_step;
  if (core::body_of(action) || std::holds_alternative<core::Spawn>(action) || all_reply) return;  // hosts reply
  // A change of the run is done when the run goes on after it.
  due_[command.request] = {
      core::changes_the_run(action) ? std::numeric_limits<core::Step>::max() : issued.order->at_step, issued.object};
}

/// Replies again to a request that is ordered already: by a lead that has died, or by this node before it started anew.
void CommandServer::reply_again(const core::Order& order, const node::Node& node) {
  core::CommandReply reply;
  reply.request = order.request;
  reply.outcome = core::Outcome::kAccepted;
  reply.at_step = order.at_step;
  if (const auto* spawn = std::get_if<core::Spawn>(&order.action)) reply.object = core::ref_of(spawn->id);
  if (const auto* fixed = std::get_if<core::AddStatic>(&order.action)) reply.object = core::ref_of(fixed->id);
  endpoint_.reply(reply);
  due_[order.request] = {std::max(order.at_step, node.current_step()), reply.object};
}

/// Acknowledges orders that other nodes have by now. A paused world publishes no batches, and in slow motion they come
/// too late for the client, so these are acknowledged early.
void CommandServer::reply_accepted(const node::Node& node, const RunView& run) {
  const bool stands = run.holds_at && node.current_step() >= *run.holds_at;
  std::erase_if(taken_, [&](Taken& one) {
    const bool is_time = stands || one.went_back || Clock::now() > one.since + kLongestUnanswered;
    if (!is_time && node.current_step() < one.known_at) return false;
    if (one.went_back && node.ordered(one.reply.request) == nullptr) {
      endpoint_.forget(one.reply.request);  // a repeated request is served anew
    } else {
      endpoint_.reply(std::move(one.reply));
    }
    return true;
  });
}

void CommandServer::go_back(node::Node& node, core::Generation generation) {
  for (const std::uint64_t request : std::exchange(not_kept_, {})) {
    endpoint_.forget(request);
    due_.erase(request);
  }
  take_over(node, generation);
}

std::optional<core::Shape> CommandServer::make_mesh(const core::MeshRef& ref) {
  const core::TriangleMesh* const mesh = mesh_reader_.mesh(ref.hash);
  return mesh == nullptr ? std::nullopt : std::optional(config::shape_for(*mesh, ref.use));
}

/// Publishes the additions to the scene, if there are new ones.
void CommandServer::publish_additions(const node::StepReport& report) {
  const std::size_t before = additions_.orders.size();
  for (const core::Order& order : report.orders) {
    if (node::changes_scene(order.action)) additions_.orders.push_back(order);
    issuer_.note(order);
  }
  if (additions_.orders.size() == before) return;
  const auto shown_later = static_cast<core::Step>(std::ceil(kLongestShown_s / launch_.step_s()));
  core::forget_moves_before(report.step - shown_later, additions_.orders);
  if (leads_) send_additions();
}

/// Publishes the additions with their meshes. The client that sent a mesh may be gone when an observer needs it.
void CommandServer::send_additions() {
  for (const core::Order& order : additions_.orders) {
    const core::MeshRef* const ref = mesh_defined_by(order);
    const core::TriangleMesh* const mesh = ref == nullptr ? nullptr : mesh_reader_.mesh(ref->hash);
    if (mesh == nullptr || meshes_published_.contains(ref->hash)) continue;
    if (!mesh_writer_) mesh_writer_.emplace(participant_);
    if (mesh_writer_->publish_again(ref->hash, *mesh)) meshes_published_.insert(ref->hash);
  }
  additions_writer_.send(additions_);
}

void CommandServer::bring(const std::vector<core::SavedMesh>& meshes) {
  for (const core::SavedMesh& saved : meshes) mesh_reader_.meshes().add_spare(saved.hash, saved.mesh);
}

void CommandServer::add_meshes(core::WorldCut& part) {
  std::set<std::uint64_t> added;
  for (const core::Order& order : part.orders) {
    const core::MeshRef* const ref = mesh_defined_by(order);
    const core::TriangleMesh* const mesh = ref == nullptr ? nullptr : mesh_reader_.mesh(ref->hash);
    if (mesh != nullptr && added.insert(ref->hash).second) part.meshes.push_back({ref->hash, *mesh});
  }
}

void CommandServer::reply_saved(const cut::PartWriter::Written& written) {
  if (!written.error.empty()) {
    return refuse(written.request, fmt::format("region {}: {}", core::value_of(region_), written.error));
  }
  core::CommandReply saved;
  saved.request = written.request;
  saved.outcome = core::Outcome::kSeen;
  saved.at_step = written.step;
  saved.text = written.file;
  endpoint_.reply(std::move(saved));
}

void CommandServer::reply_done(std::uint64_t request, core::Step step, std::optional<core::ObjectRef> object) {
  core::CommandReply done;
  done.object = object;
  done.request = request;
  done.outcome = core::Outcome::kDone;
  done.at_step = step;
  endpoint_.reply(std::move(done));
}

void CommandServer::reply_all_done(core::Step step) {
  for (const auto& [request, due] : std::exchange(due_, {})) reply_done(request, step, due.object);
}

void CommandServer::after_step(const node::StepReport& report) {
  publish_additions(report);
  for (const node::Applied& applied : report.applied) reply_done(applied.request, applied.step, applied.object);
  for (const physics::Declined& declined : report.declined) refuse(declined.request, declined.why);
  std::erase_if(due_, [&](const auto& entry) {
    if (entry.second.step > report.step) return false;
    reply_done(entry.first, report.step, entry.second.object);
    return true;
  });
}

}  // namespace aurasim::process
