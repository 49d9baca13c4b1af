#include "config/launch_keys.h"

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "config/launch_checks.h"
#include "config/presets.h"
#include "config/region_layout.h"
#include "core/block.h"

namespace aurasim::config {
namespace {

std::string presets_text() {
  std::string text =
      "sets solver, iterations, time.substeps and friction_directions at once; what is given beside it goes before "
      "it: ";
  for (const Preset& preset : kPresets) {
    text += fmt::format("{}{} is {}, {}, {}, {}", &preset == kPresets.data() ? "" : "; ", preset.name, preset.solver,
                        preset.iterations, preset.substeps, preset.friction_directions);
  }
  return text;
}

}  // namespace

const KeysOf<Time>& time_keys() {
  static const KeysOf<Time> keys(
      "time", "How the world goes on: steps, and who waits for whom.",
      {
          optional("step_hz", &Time::step_hz, number(Range::from_to(1, 10'000), "Hz"),
                   "steps of the world per simulated second; nodes exchange what they know once a step"),
          optional("substeps", &Time::substeps, integer(1, 64),
                   "steps of the physics in each step of the world: more are more accurate, and cost as much more"),
          optional("sync", &Time::sync,
                   choice<core::SyncMode>({{"free_running", core::SyncMode::kFreeRunning},
                                           {"bounded", core::SyncMode::kBounded},
                                           {"deterministic", core::SyncMode::kDeterministic}}),
                   "bounded: waits for neighbours, so a slow network makes it slower, never wrong; deterministic: the "
                   "same bits in every run on any number of nodes; free_running: never waits, counts what came too "
                   "late"),
          optional("lookahead", &Time::lookahead, integer(1, kLargestLookahead, "steps").or_word("auto"),
                   "K, how many steps neighbours may be apart; auto: ceil((tolerances.frame + tolerances.latency) * "
                   "step_hz)")
              .usual("auto"),
          optional("redo", &Time::redo, choice<Redo>({{"auto", Redo::kAuto}, {"on", Redo::kOn}, {"off", Redo::kOff}}),
                   "on: every state is checked, and where two bodies have touched on two hosts all nodes go back and "
                   "compute on with the two on one: the result is that of one node; off: such a touch is counted, if "
                   "it is seen; auto: on where sync is deterministic. Not for free_running"),
          optional("pace", &Time::pace, choice<Pace>({{"wall", Pace::kWall}, {"none", Pace::kNone}}),
                   "wall: a simulated second takes a second of the clock; none: as fast as it goes"),
      });
  return keys;
}

const KeysOf<Tolerances>& tolerances_keys() {
  static const KeysOf<Tolerances> keys(
      "tolerances",
      "Bounds that the run promises to keep; lookahead and auras are made for them. A broken promise is counted: a "
      "collision may have come late, or been missed.",
      {
          optional("speed", &Tolerances::speed_m_s, number(Range::from_to(1e-3, 1e4), "m/s"),
                   "no body is faster; auras reach, and regions have to be wide, in proportion to it"),
          optional("latency", &Tolerances::latency_s, number(Range::from_to(0, 10), "s"),
                   "no message is longer on its way from node to node"),
          optional("frame", &Tolerances::frame_s, number(Range::from_to(1e-6, 10), "s"),
                   "no node takes longer for a step"),
      });
  return keys;
}

const KeysOf<Aura>& aura_keys() {
  static const KeysOf<Aura> keys(
      "aura", "How far ahead of its bodies a node warns its neighbours.",
      {
          optional("radius", &Aura::radius,
                   choice<core::AuraKind>({{"none", core::AuraKind::kNone},
                                           {"thesis", core::AuraKind::kThesis},
                                           {"tight", core::AuraKind::kTight},
                                           {"swept", core::AuraKind::kSwept}}),
                   "swept: along the path of the body; tight and thesis: a sphere around it, by our and by the thesis' "
                   "formula; none: the control that must fail, with time.redo off"),
          optional("uncertainty", &Aura::uncertainty, number(Range::from_to(0, 10)).or_word("auto"),
                   "U, share of its speed by which a body may leave its foreseen path before that counts as broken; "
                   "auto: 0.5, from a lookahead K of 4 on 1.2 / K, with sync free_running 1.5")
              .usual("auto"),
      });
  return keys;
}

const KeysOf<Physics>& physics_keys() {
  static const std::string kPresetsText = presets_text();
  static const KeysOf<Physics> keys(
      "physics", "Bullet, and how accurate it is.",
      {
          optional("preset", choice<int>({{kPresets[0].name, 0}, {kPresets[1].name, 1}, {kPresets[2].name, 2}}),
                   kPresetsText)
              .otherwise("none: the defaults of this page"),
          optional("solver", &Physics::solver, words({"sequential_impulse", "soft_step"}),
                   "of contacts and joints: sequential_impulse is projected Gauss-Seidel; soft_step looks once a step "
                   "for what touches, solves in the substeps, and knows no iterations, friction_directions and erp"),
          optional("iterations", &Physics::iterations, integer(1, 1000), "of the solver in each substep"),
          optional("friction_directions", &Physics::friction_directions, integer(1, 2),
                   "rows of friction at each contact point; with 1, piles creep and a card house falls"),
          optional("erp", &Physics::contact_erp, number(Range::from_to(0, 1)),
                   "share of an overlap that contacts undo in each substep, by a speed that stays"),
          optional("continuous", &Physics::continuous, flag().or_word("auto"),
                   "continuous collision detection: fast bodies stop at what is in their way instead of passing "
                   "through what is thin; auto: with soft_step")
              .usual("auto"),
          optional("block", &Physics::block_m,
                   number(Range::from_to(core::kSmallestBlock_m, core::kLargestBlock_m), "m").or_word("auto"),
                   "side of the square columns into which the world is cut; contacts inside a column are solved before "
                   "those between columns. auto: 16, or as much as the sizes of the scene's bodies need")
              .usual("auto"),
          optional("threads", &Physics::threads, integer(1, 64).or_word("auto"),
                   "of each node's soft_step, at most; small worlds use fewer, and their number changes no bit. auto: "
                   "the cores that the process may use, shared among the nodes of the run")
              .usual("auto"),
      });
  return keys;
}

const KeysOf<Impair>& impair_keys() {
  static const KeysOf<Impair> keys(
      "dds.impair", "A worse network than there is: every process holds back or drops the datagrams that it sends.",
      {
          optional("delay", &Impair::delay_s, number(Range::from_to(0, 10), "s"), "one way, of each datagram")
              .otherwise("the profile's, or 0"),
          optional("jitter", &Impair::jitter_s, number(Range::from_to(0, 10), "s"),
                   "delay +- jitter, uniform, never early")
              .otherwise("the profile's, or 0"),
          optional("loss", &Impair::loss, number(Range::from_to(0, 1)),
                   "share of the datagrams that are dropped, each for itself; DDS sends what is lost again")
              .otherwise("the profile's, or 0"),
          optional("bandwidth", &Impair::bandwidth_B_s, number(Range::from_to(0, 1e12), "B/s"),
                   "of all that one process sends, UDP payload; 0: unlimited")
              .otherwise("the profile's, or 0"),
          optional("reorder", &Impair::reorder, flag(),
                   "jitter lets a datagram overtake another one to the same destination")
              .otherwise("the profile's, or false"),
          optional("discovery", &Impair::discovery, flag(), "DDS discovery suffers as well")
              .otherwise("the profile's, or false"),
          optional("seed", &Impair::seed, integer(0, INT64_MAX),
                   "of the random numbers; each region has its own from it")
              .otherwise("the profile's, or 1"),
      });
  return keys;
}

const KeysOf<Dds>& dds_keys() {
  static const KeysOf<Dds> keys(
      "dds", "How the nodes find each other. All but the domain may differ between hosts.",
      {
          optional("domain", &Dds::domain, integer(0, 232), "runs at the same time need different ones"),
          optional("profiles", text("an XML file"), "QoS profiles, relative to this file")
              .otherwise("`../qos/aurasim.xml`, or where that is not, the one that comes with the program"),
          optional(
              "discovery", &Dds::discovery,
              choice<Discovery>({{"auto", Discovery::kAuto},
                                 {"multicast", Discovery::kMulticast},
                                 {"peers", Discovery::kPeers},
                                 {"server", Discovery::kServer},
                                 {"neighbours", Discovery::kNeighbours}}),
              "multicast; peers: announcements go to the addresses in `peers`; server: Fast DDS discovery servers "
              "at `peers`; neighbours: a hub (`aurasim hub`; `launch` starts one) introduces the nodes that need each "
              "other, for many nodes and for sites without multicast between them; auto: multicast, but `launch` uses "
              "neighbours for more than 16 nodes on loopback, with keys for more than 9"),
          optional("interfaces", &Dds::interfaces, list(1, 256, text("an address")),
                   "own addresses that may carry traffic; [\"*\"]: all of them. The default never leaves the machine"),
          optional(
              "peers", &Dds::peers, list(1, 256, text("an address")),
              "ADDRESS or ADDRESS:PORT; required with discovery: peers and server. With neighbours: the hubs of the "
              "other sites, which only a hub needs to know")
              .otherwise("none"),
          optional(
              "hub", &Dds::hub, text("an address"),
              "with discovery: neighbours, where the hub of this site is; required with interfaces that are not of "
              "loopback")
              .otherwise("on loopback"),
          optional("security", text("a folder"),
                   "keys made by `aurasim keys`, relative to this file: only a process that has one joins the run, and "
                   "messages are encrypted")
              .otherwise("none: an open run, which every process that reaches the network can join"),
          optional("impair", &Dds::impair, impair_keys, "a worse network than there is"),
      });
  return keys;
}

const KeysOf<Observe>& observe_keys() {
  static const KeysOf<Observe> keys("observe", "This section sets what nodes publish for observers.",
                                    {
                                        optional("tick_hz", &Observe::tick_hz, number(Range::from_to(1e-3, 1000), "Hz"),
                                                 "how often nodes publish changes for the viewer"),
                                    });
  return keys;
}

const KeysOf<Control>& control_keys() {
  static const KeysOf<Control> keys(
      "control", "Setpoints of programs that steer bodies and joints (docs/client.md).",
      {
          optional("late", &Control::late,
                   choice<core::LateSetpoint>(
                       {{"next", core::LateSetpoint::kNextState}, {"drop", core::LateSetpoint::kDropped}}),
                   "what comes too late for the state that it names takes effect in the next one, or not at all; it is "
                   "counted either way"),
          optional("silence", &Control::silence_s, number(Range::from_to(0.001, 1e6), "s"),
                   "simulated; a program from which nothing was received for longer has fallen silent"),
          optional("on_silence", &Control::on_silence,
                   choice<core::OnSilence>({{"hold", core::OnSilence::kHold},
                                            {"zero", core::OnSilence::kZero},
                                            {"last", core::OnSilence::kLast}}),
                   "hold: what it has steered stops: no force and no speed, and drives keep their positions; zero: all "
                   "is let go of; last: as it said last, for ever"),
          optional("replay", text("a file"),
                   "setpoints.csv of an earlier run's report, relative to this file: takes effect in the same states")
              .otherwise("none"),
      });
  return keys;
}

const KeysOf<Ros2>& ros2_keys() {
  static const KeysOf<Ros2> keys(
      "ros2",
      "This section sets what nodes publish to ROS 2 and receive from it, by DDS alone (docs/ros2.md). `{}` is on.",
      {
          optional("domain", &Ros2::domain, integer(0, 232), "ROS_DOMAIN_ID of those who listen")
              .otherwise("the run's"),
          optional("tf_hz", &Ros2::tf_hz, number(Range::from_to(1e-3, 1000), "Hz"),
                   "simulated; how often /clock, /tf and /joint_states are said"),
          optional("frame", &Ros2::frame, text("a frame"), "parent of all frames in /tf"),
          optional("cmd_vel", &Ros2::cmd_vel, list(0, 1000, text("the name of a body")),
                   "bodies that listen to /NAME/cmd_vel, and drive as mobile bases")
              .otherwise("none"),
      });
  return keys;
}

const KeysOf<Survival>& survival_keys() {
  static const KeysOf<Survival> keys(
      "survival", "How the run goes on when one of its nodes dies.",
      {
          optional("on_death", &Survival::on_death,
                   choice<OnDeath>({{"recover", OnDeath::kRecover}, {"stop", OnDeath::kStop}}),
                   "recover: all stand until a process has taken the region over, go back to the newest state that is "
                   "kept of every region, and compute on from there: no body is lost, the bits are those of a run "
                   "without a death; where nobody takes the region over, the run ends. stop: the run ends"),
          optional("checkpoint", &Survival::checkpoint_s, number(Range::from_to(0.001, 1e6), "s"),
                   "simulated time from one state that can be gone back to until the next: longer costs less, and has "
                   "more to be computed again"),
          optional("patience", &Survival::patience_s, number(Range::from_to(0, 1e6), "s"),
                   "so long the others wait for a spare, or for the launcher; then the host of the next region starts "
                   "a process that takes the region over. Where that does not help either, the run ends"),
          optional("disk", &Survival::disk, text("a folder, or off"),
                   "each node also writes its part of the states that can be gone back to into a folder of its run "
                   "beneath this one, relative to this file, and keeps the newest: `launch --resume` goes on from "
                   "them when all processes have ended at once")
              .otherwise("the folder of --saves, where that is given"),
      });
  return keys;
}

const KeyTable& tls_keys() {
  static const KeyTable keys{
      .title = "overseer.tls",
      .about = "HTTPS, from TLS 1.2 on. The files are needed, and looked at, where the viewer's server runs only.",
      .keys = {required("certificate", text("a PEM file"),
                        "with those of its issuers behind it, if there are any; relative to this file"),
               required("key", text("a PEM file"),
                        "its private key, without a passphrase, not to be read by everybody; relative to this file")}};
  return keys;
}

const KeysOf<Overseer>& overseer_keys() {
  static const KeysOf<Overseer> keys(
      "overseer", "The viewer's server.",
      {
          optional(
              "bind", &Overseer::bind, text("an address"),
              "address that it listens on; on any other than this machine's own, tokens, printed at the start, are "
              "needed to look at the world and to change it"),
          optional("port", &Overseer::port, integer(0, 65535), "0: any that is free"),
          optional("tls", map(tls_keys), "HTTPS instead of HTTP").otherwise("plain HTTP"),
      });
  return keys;
}

const KeyTable& regions_keys() {
  static const KeyTable keys{
      .title = "regions",
      .about =
          "How the plane is divided. The outermost regions reach to infinity; `count: 1` is the central run, in "
          "every layout, and needs nothing else.",
      .keys = {optional("neighbour_distance", number(Range::from_to(0, 1e6), "m"),
                        "regions at most this far apart listen to each other; never less than the default")
                   .otherwise("as far as bodies may matter to each other, from tolerances and lookahead")}};
  return keys;
}

const KeysOf<Launch>& launch_keys() {
  static const KeysOf<Launch> keys(
      "launch file", "Which scene, on how many nodes, and how. Paths are relative to the file.",
      {
          required("scene", text("a scene file"), "what the world is made of; relative to this file"),
          required("regions", layout_value().with(regions_keys), "how the plane is divided among the nodes"),
          optional(
              "exchange", &Launch::exchange,
              choice<Exchange>({{"aura", Exchange::kAura}, {"coupled", Exchange::kCoupled}, {"auto", Exchange::kAuto}}),
              "how bodies of two regions touch. aura: one node gets both in time, which hides the latency between "
              "nodes; coupled: all their nodes solve the contact together, several messages a step, for nodes of "
              "one host or rack; auto: coupled where it is possible, regions are 16 or fewer and the nodes measure "
              "short round trips when they meet (exchange_limit), else aura"),
          optional("exchange_limit", &Launch::exchange_limit_given_s, number(Range::from_to(1e-6, 10), "s"),
                   "longest round trip between nodes at which exchange: auto means coupled")
              .otherwise("half a step's time, divided by its exchanges: 2 time.substeps + 1"),
          optional("time", &Launch::time, time_keys, "steps, and who waits for whom"),
          optional("tolerances", &Launch::tolerances, tolerances_keys, "what the run promises to itself"),
          optional("aura", &Launch::aura, aura_keys, "how far ahead nodes warn each other"),
          optional("physics", &Launch::physics, physics_keys, "Bullet, and how accurate it is"),
          optional("dds", map(dds_keys), "how nodes find each other"),
          optional("survival", &Launch::survival, survival_keys, "what happens when a node dies"),
          optional("observe", &Launch::observe, observe_keys, "what nodes publish for observers"),
          optional("control", map(control_keys), "programs that steer bodies and joints"),
          optional("ros2", map(ros2_keys).or_else(words({"on", "off"})),
                   "what nodes publish to ROS 2 and receive from it")
              .usual("off"),
          optional("overseer", map(overseer_keys), "the viewer's server"),
      });
  return keys;
}

const KeyTable& launch_file_keys() { return launch_keys(); }

}  // namespace aurasim::config
