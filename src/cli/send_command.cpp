#include <algorithm>
#include <charconv>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "cli/commands.h"
#include "command_line/exit_code.h"
#include "command_line/leave.h"
#include "core/limits.h"
#include "cut/saved_parts.h"
#include "cut/saved_world.h"
#include "setup/arguments.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"
#include "setup/silence.h"
#include "steering/client_mesh.h"
#include "steering/command_client.h"
#include "steering/drain.h"
#include "steering/run_steering.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Kind = dds::RunCommandKind;
using Numbers = std::vector<double>;

constexpr auto kPatienceWithAPause = 10s;
constexpr auto kPatienceWithTheRun = 60s;  ///< in slow motion an order's state may take that long

const std::map<std::string, Kind> kSteering = {{"pause", Kind::kPause},
                                               {"resume", Kind::kResume},
                                               {"step", Kind::kStep},
                                               {"reset", Kind::kReset},
                                               {"stop", Kind::kStop}};

struct SendArguments {
  command_line::FileArguments files;
  setup::KeyArguments keys;
  std::string what;
  std::int64_t count = 1;
  core::Step at_step = 0;
  std::string prototype;
  std::string mesh_file;
  bool in_parts = false;
  std::string scene;
  std::string save_name;
  std::optional<std::uint64_t> body;
  std::uint32_t region = 0;
  std::string named;
  double duration_s = 0;
  double radius_m = 0;
  double height_m = 0;
  double mass_kg = 1;
  double rate = 1;
  Numbers size, p, q, v, w, J, from, to, boxes;
};

[[noreturn]] void fail(const std::string& why) {
  spdlog::error("{}", why);
  command_line::leave(static_cast<int>(command_line::ExitCode::kFailed));
}

core::Vec3 vector(const Numbers& v) { return v.size() == 3 ? core::Vec3(v[0], v[1], v[2]) : core::Vec3::Zero(); }

core::Pose pose(const SendArguments& a) {
  core::Pose pose{vector(a.p), core::Quat::Identity()};
  if (a.q.size() != 4) return pose;
  const core::Quat q(a.q[0], a.q[1], a.q[2], a.q[3]);
  if (!(q.norm() > 1e-6 && q.norm() < 1e6)) fail("--q: this is no rotation; a quaternion w x y z, e.g. 1 0 0 0");
  pose.q_WB = q.normalized();
  return pose;
}

core::ClientShape shape(const SendArguments& a, core::MeshUse use, steering::CommandClient& client) {
  if (!a.mesh_file.empty()) return steering::bring_mesh(a.mesh_file, use, client);
  if (a.size.size() == 3) return core::Box{vector(a.size) / 2};
  if (a.radius_m > 0 && a.height_m > 0) return core::Capsule{a.radius_m, a.height_m};
  if (a.radius_m > 0) return core::Sphere{a.radius_m};
  fail("which shape? --size X Y Z, --radius R [--height H] or --mesh FILE");
}

core::StaticId static_named(const std::string& named, const core::Scene& scene) {
  if (const auto found = core::find_static(scene, named)) return *found;
  std::uint32_t id = 0;
  const auto [end, error] = std::from_chars(named.data(), named.data() + named.size(), id);
  if (error != std::errc() || end != named.data() + named.size())
    fail("--static " + named + ": neither a name of the scene nor a number");
  return core::StaticId{id};
}

std::string sound_name(const std::string& name) {
  if (const std::string why = cut::refused_save_name(name); !why.empty()) fail(why);
  return name;
}

core::Ask ask_for(const SendArguments& a, const core::Scene& scene, steering::CommandClient& client) {
  if (a.what == "spawn") {
    core::NewBody body;
    body.prototype = a.prototype;
    const core::MeshUse use = a.in_parts ? core::MeshUse::kDecomposition : core::MeshUse::kHull;
    if (a.prototype.empty()) body.shape = shape(a, use, client);
    body.mass_kg = a.mass_kg;
    body.pose = pose(a);
    body.v_WB = vector(a.v);
    body.w_WB = vector(a.w);
    return body;
  }
  if (a.what == "static") return core::NewStatic{shape(a, core::MeshUse::kTriangles, client), pose(a)};
  if (a.what == "remove" && !a.body) return core::RemoveStatic{static_named(a.named, scene)};
  if (a.what == "move") return core::SendStatic{static_named(a.named, scene), pose(a), a.duration_s};
  if (a.what == "remove") return core::RemoveBody{core::BodyId{*a.body}};
  if (a.what == "impulse") {
    return core::Impulse{core::BodyId{*a.body}, vector(a.J), a.p.empty() ? std::nullopt : std::optional(vector(a.p))};
  }
  if (a.what == "velocity") {
    return core::SetVelocity{core::BodyId{*a.body}, vector(a.v),
                             a.w.empty() ? std::nullopt : std::optional(vector(a.w))};
  }
  if (a.what == "rate") return core::SetRate{a.rate};
  if (a.what == "scene") return core::ChangeScene{a.scene};
  if (a.what == "load") return core::Load{sound_name(a.save_name)};
  if (a.what == "back") return core::Load{};
  if (a.what == "save") return core::Save{sound_name(a.save_name)};
  if (a.what == "ray") return core::Ray{vector(a.from), vector(a.to), {}};
  core::Repartition regions;
  for (std::size_t i = 0; i + 3 < a.boxes.size(); i += 4) {
    regions.boxes.push_back({a.boxes[i], a.boxes[i + 1], a.boxes[i + 2], a.boxes[i + 3]});
  }
  return regions;
}

nlohmann::json json_list(const core::Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Joins the parts into one file, if all of them are on this host.
nlohmann::json whole_or_parts(const std::vector<std::string>& parts, const std::string& name) {
  const cut::PutTogether made = cut::put_together(parts, name);
  if (!made.file.empty()) return {{"file", made.file}, {"bytes", made.bytes}};
  spdlog::warn("the parts are on their nodes' hosts: `aurasim cut merge {} PART...` puts them together", name);
  return {{"parts", parts}};
}

[[noreturn]] void print_delivery(const steering::Delivery& delivery, const SendArguments& arguments) {
  if (!delivery.done) fail(delivery.text);
  nlohmann::json out = {{"step", delivery.at_step}};
  if (delivery.is_save && !delivery.files.empty()) out.update(whole_or_parts(delivery.files, arguments.save_name));
  if (delivery.object)
    out[*delivery.object >= 0 ? "body" : "static"] = *delivery.object >= 0 ? *delivery.object : -1 - *delivery.object;
  if (delivery.is_ray) {
    out["hit"] = delivery.object.has_value();
    out["complete"] = delivery.silent.empty();
    if (delivery.object) {
      out["p"] = json_list(delivery.p_W);
      out["normal"] = json_list(delivery.normal_W);
      out["distance_m"] = delivery.distance_m;
    }
  }
  fmt::print("{}\n", out.dump());
  command_line::leave(0);
}

[[noreturn]] void carry(const SendArguments& arguments, dds::Participant& participant, dds::ControlBus& control,
                        const config::Launch& launch) {
  steering::CommandClient client(participant, control, launch.agreement());
  const auto deadline = std::chrono::steady_clock::now() + kPatienceWithTheRun;
  const auto in_time = [&] { return std::chrono::steady_clock::now() < deadline; };
  while (!client.all_listen() && in_time()) client.wait(20ms);
  core::Command command;
  command.at_step = arguments.at_step;
  command.ask = ask_for(arguments, launch.scene, client);
  client.send(std::move(command));
  while (in_time()) {
    client.wait(20ms);
    for (const steering::Delivery& delivery : client.take()) print_delivery(delivery, arguments);
  }
  fail("no answer");
}

[[noreturn]] void steer(const SendArguments& arguments, steering::RunSteering& steering) {
  // A world that has gone back in a pause first computes up to the paused state again.
  if (arguments.what == "step" && !steering.wait_until_paused(kPatienceWithAPause))
    fail("steps are for a run that is paused");
  const dds::RunCommand command = steering.send(kSteering.at(arguments.what), arguments.count);
  if (!steering.wait_for_effect(command, kPatienceWithTheRun)) {
    fail(fmt::format("{} was sent, but not every node shows its effect", arguments.what));
  }
  fmt::print("{}: done at step {}\n", arguments.what, command.at_step);
  command_line::leave(0);
}

/// Drains a region. Done when another process computes the region and the run goes on.
[[noreturn]] void drain(const SendArguments& arguments, dds::ControlBus& control) {
  steering::Drain leaving(control, core::RegionId{arguments.region});
  const auto deadline = std::chrono::steady_clock::now() + kPatienceWithTheRun;
  while (std::chrono::steady_clock::now() < deadline) {
    control.wait(20ms);
    const dds::Status* const successor = leaving.successor();
    if (successor == nullptr) continue;
    fmt::print("drain: process {} has taken region {} over by step {}\n", successor->pid, arguments.region,
               successor->step);
    command_line::leave(0);
  }
  fail("nobody has taken the region over: is there a spare, or a launcher?");
}

int send(const SendArguments& arguments) {
  const config::Launch launch = config::read_launch(arguments.files.file, arguments.files.overrides);
  const auto member = setup::member_for(launch, arguments.keys.as, {security::Role::kOperator});
  dds::Participant participant(setup::with_keys(setup::dds_settings(launch), launch, member));
  dds::ControlBus control(participant, {.agreement = launch.agreement(),
                                        .region_count = static_cast<std::uint32_t>(launch.regions.size())});
  steering::RunSteering steering(launch, control);
  if (!steering.find_run(5s)) {
    const bool differs = !control.strangers().empty();
    fail(fmt::format("no run of {} in DDS domain {}{}{}", arguments.files.file, launch.dds.domain,
                     differs ? ", but one that differs: give the same file and --set as its nodes have" : "",
                     setup::word_about_keys(participant.peers_by_keys(), launch)));
  }
  command_line::leave_after([&]() -> command_line::ExitCode {
    if (arguments.what == "drain") drain(arguments, control);
    if (kSteering.contains(arguments.what)) steer(arguments, steering);
    carry(arguments, participant, control, launch);
  });
}

using Options = std::function<void(CLI::App&, SendArguments&)>;

void vector_option(CLI::App& command, const char* name, Numbers& value, const char* text, int count = 3) {
  command.add_option(name, value, text)->expected(count);
}

void shape_options(CLI::App& command, SendArguments& a) {
  vector_option(command, "--size", a.size, "a box, side lengths in m");
  command.add_option("--radius", a.radius_m, "a ball, m; with --height a capsule along z");
  command.add_option("--height", a.height_m, "between the centres of the capsule's caps, m");
  command.add_option("--mesh", a.mesh_file, "OBJ, STL or glTF file; bodies take its hull")->check(CLI::ExistingFile);
}

void place_options(CLI::App& command, SendArguments& a) {
  vector_option(command, "--p", a.p, "position, m");
  vector_option(command, "--q", a.q, "rotation, quaternion w x y z", 4);
}

void spawn_options(CLI::App& command, SendArguments& a) {
  command.add_option("--prototype", a.prototype, "name of one of the scene's, instead of a shape");
  shape_options(command, a);
  command.add_flag("--parts", a.in_parts, "with --mesh: convex parts that it is taken apart into, instead of its hull");
  place_options(command, a);
  vector_option(command, "--v", a.v, "velocity, m/s");
  vector_option(command, "--w", a.w, "angular velocity, rad/s");
  command.add_option("--mass", a.mass_kg, "kg");
}

void static_options(CLI::App& command, SendArguments& a) {
  shape_options(command, a);
  place_options(command, a);
}

void remove_options(CLI::App& command, SendArguments& a) {
  CLI::Option* body = command.add_option("--body", a.body, "id");
  command.add_option("--static", a.named, "its name in the scene, or its id")->excludes(body);
  command.parse_complete_callback([&command] {
    if (command.count("--body") + command.count("--static") == 0) throw CLI::RequiredError("--body or --static");
  });
}

void move_options(CLI::App& command, SendArguments& a) {
  command.add_option("--static", a.named, "its name in the scene, or its id")->required();
  place_options(command, a);
  command.add_option("--seconds", a.duration_s, "of simulated time, until it is there");
}

void impulse_options(CLI::App& command, SendArguments& a) {
  command.add_option("--body", a.body, "id")->required();
  vector_option(command, "--J", a.J, "impulse, N s");
  vector_option(command, "--p", a.p, "point of attack, m; otherwise the centre of mass");
}

void velocity_options(CLI::App& command, SendArguments& a) {
  command.add_option("--body", a.body, "id")->required();
  vector_option(command, "--v", a.v, "m/s");
  vector_option(command, "--w", a.w, "rad/s; otherwise the spin stays");
}

void ray_options(CLI::App& command, SendArguments& a) {
  vector_option(command, "--from", a.from, "m");
  vector_option(command, "--to", a.to, "m");
}

/// Example arguments that follow `aurasim send KIND demo`.
const std::map<std::string, std::string> kExamples = {
    {"step", "--count 10"},
    {"spawn", "--radius 0.5 --p 0 0 10 --v 5 0 0"},
    {"static", "--size 4 4 1 --p 0 0 0.5"},
    {"remove", "--body 3"},
    {"move", "--static gate --p 0 0 3 --seconds 2"},
    {"impulse", "--body 3 --J 0 0 20"},
    {"velocity", "--body 3 --v 0 0 8"},
    {"rate", "--value 0.5"},
    {"scene", "--name tower"},
    {"regions", "--boxes -40 -40 0 0 0 -40 40 0 -40 0 0 40 0 0 40 40"},
    {"drain", "2"},
    {"save", "world.cut"},
    {"load", "state-1200.cut"},
    {"ray", "--from 0 0 20 --to 0 0 0"}};

std::string example_of(const std::string& kind) {
  const auto options = kExamples.find(kind);
  return fmt::format("Example:\n  aurasim send {} demo{}", kind,
                     options == kExamples.end() ? "" : " " + options->second);
}

}  // namespace

void add_send(CLI::App& program, command_line::Action& action) {
  CLI::App* send_app = program.add_subcommand("send", "tell a run what to do");
  send_app->require_subcommand(1);
  send_app->footer("Example:\n  aurasim send spawn demo --radius 0.5 --p 0 0 10 --v 5 0 0");
  const auto arguments = std::make_shared<SendArguments>();
  const auto none = [](CLI::App&, SendArguments&) {};
  const std::vector<std::tuple<const char*, const char*, Options>> kinds = {
      {"pause", "stand still", none},
      {"resume", "go on", none},
      {"step", "compute some states while paused",
       [](CLI::App& c, SendArguments& a) {
         c.add_option("--count", a.count, "how many")->check(CLI::Range(1, 1'000'000));
       }},
      {"reset", "begin anew", none},
      {"stop", "end the run", none},
      {"spawn", "a new body", spawn_options},
      {"static", "a new static, on every node", static_options},
      {"remove", "take a body or a static out", remove_options},
      {"move", "send a static somewhere: a gate, a lift", move_options},
      {"impulse", "push a body", impulse_options},
      {"velocity", "set a body's velocity", velocity_options},
      {"rate", "slow motion and the like",
       [](CLI::App& c, SendArguments& a) {
         c.add_option("--value", a.rate, "simulated seconds per second")
             ->required()
             ->check(CLI::Range(core::limits::kSlowestRate, core::limits::kFastestRate));
       }},
      {"scene", "begin anew with another scene",
       [](CLI::App& c, SendArguments& a) { c.add_option("--name", a.scene, "of its file")->required(); }},
      {"regions", "give the nodes other regions",
       [](CLI::App& c, SendArguments& a) {
         c.add_option("--boxes", a.boxes, "x0 y0 x1 y1 of each region, m")->required()->expected(4, 4096);
       }},
      {"drain", "let a region's node leave: another process takes the region over",
       [](CLI::App& c, SendArguments& a) { c.add_option("REGION", a.region, "whose node")->required(); }},
      {"save", "keep the world in a file",
       [](CLI::App& c, SendArguments& a) {
         c.add_option("WORLD", a.save_name, "its name: of a file in the nodes' --saves folder")->required();
       }},
      {"load", "go on from a saved world",
       [](CLI::App& c, SendArguments& a) {
         c.add_option("WORLD", a.save_name, "its name: of a file in the nodes' --saves folder")->required();
       }},
      {"back", "go back to the newest earlier state that is kept", none},
      {"ray", "what is first on the way from a point to another?", ray_options}};
  for (const auto& [name, text, options] : kinds) {
    CLI::App* command = send_app->add_subcommand(name, text);
    arguments->files.add_to(*command);
    arguments->keys.add_to(*command);
    options(*command, *arguments);
    command->add_option("--at", arguments->at_step, "not before this state");
    command->footer(example_of(name));
    command->callback([arguments, &action, what = std::string(name)] {
      arguments->what = what;
      action = [arguments] { return send(*arguments); };
    });
  }
}

}  // namespace aurasim::cli
