#include "records/setpoint_record.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/limits.h"
#include "core/static_moves.h"
#include "records/csv.h"

namespace aurasim::records {
namespace {

constexpr std::array<std::string_view, core::kQuantities> kQuantityNames = {"force", "torque", "velocity", "spin",
                                                                            "driving"};
constexpr std::string_view kDrive = "drive";
constexpr std::string_view kMove = "move";
constexpr std::size_t kColumns = 12, kFirstNumber = 4, kMoveNumbers = 8;

std::string row(core::RegionId region, core::Step step, std::string_view what, std::uint64_t id,
                std::span<const double> numbers) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{},{},{},{}", core::value_of(region), step, what, id);
  for (std::size_t i = 0; i < kColumns - kFirstNumber; ++i) {
    text += ',';
    if (i < numbers.size()) fmt::format_to(out, "{}", numbers[i]);
  }
  return text += '\n';
}

std::optional<double> finite_or_infinite(std::string_view cell) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size() || value != value) return {};
  return value;
}

/// Sequence number of a recorded setpoint. Of two for one state, the one with a value comes last and so counts.
std::uint64_t sequence_of(bool says_something) { return says_something ? 2 : 1; }

std::optional<core::BodyEffect> body_effect(std::string_view what, core::Step step, std::uint64_t id,
                                            const std::vector<double>& numbers) {
  const std::optional<core::Quantity> quantity = quantity_named(what);
  if (!quantity || (!numbers.empty() && numbers.size() != 3)) return {};
  core::BodyEffect effect{step, {core::BodyId{id}, *quantity, {}}};
  if (!numbers.empty()) effect.setpoint.value = core::Vec3(numbers[0], numbers[1], numbers[2]);
  return effect;
}

std::optional<core::JointEffect> joint_effect(core::Step step, std::uint64_t id, const std::vector<double>& numbers) {
  constexpr std::size_t kNumbers = core::JointDrive::kNumbers;
  if (!numbers.empty() && numbers.size() != kNumbers) return {};
  core::JointEffect effect{step, {core::JointId{static_cast<std::uint32_t>(id)}, {}}};
  if (!numbers.empty()) effect.setpoint.drive = core::JointDrive::of(std::span(numbers).first<kNumbers>());
  return effect;
}

std::optional<core::StaticEffect> static_effect(core::Step step, std::uint64_t id, const std::vector<double>& n) {
  if (n.size() != kMoveNumbers) return {};
  if (!(std::abs(n[7]) <= core::limits::kMostStepsAhead)) return {};
  const core::Pose to{core::Vec3(n[0], n[1], n[2]), core::Quat(n[3], n[4], n[5], n[6])};
  const core::StaticSetpoint wanted{core::StaticId{static_cast<std::uint32_t>(id)}, to, static_cast<core::Step>(n[7])};
  return core::is_sound(wanted) ? std::optional(core::StaticEffect{step, wanted}) : std::nullopt;
}

/// Reads one row. Nothing is returned if it is no row of setpoints.
std::optional<core::Setpoints> read_row(std::span<const std::string_view> cells) {
  if (cells.size() != kColumns) return {};
  const auto step = finite_or_infinite(cells[1]), id = finite_or_infinite(cells[3]);
  if (!step || !id || *step < 1 || *id < 0 || *step > 1e15 || *id > 1e18) return {};
  std::vector<double> numbers;
  for (std::size_t i = kFirstNumber; i < kColumns && !cells[i].empty(); ++i) {
    const std::optional<double> one = finite_or_infinite(cells[i]);
    if (!one) return {};
    numbers.push_back(*one);
  }
  const auto at = static_cast<core::Step>(*step);
  if (cells[2] == kDrive) {
    const auto effect = joint_effect(at, static_cast<std::uint64_t>(*id), numbers);
    return effect ? std::optional(as_heard_again(*effect)) : std::nullopt;
  }
  if (cells[2] == kMove) {
    const auto effect = static_effect(at, static_cast<std::uint64_t>(*id), numbers);
    return effect ? std::optional(as_heard_again(*effect)) : std::nullopt;
  }
  const auto effect = body_effect(cells[2], at, static_cast<std::uint64_t>(*id), numbers);
  return effect ? std::optional(as_heard_again(*effect)) : std::nullopt;
}

}  // namespace

std::optional<core::Quantity> quantity_named(std::string_view name) {
  const auto found = std::ranges::find(kQuantityNames, name);
  if (found == kQuantityNames.end()) return {};
  return static_cast<core::Quantity>(found - kQuantityNames.begin());
}

std::string setpoint_row(core::RegionId region, const core::BodyEffect& effect) {
  const core::BodySetpoint& body = effect.setpoint;
  std::span<const double> numbers;
  if (body.value) numbers = {body.value->data(), 3};
  return row(region, effect.step, kQuantityNames.at(static_cast<std::size_t>(body.quantity)), core::value_of(body.id),
             numbers);
}

std::string setpoint_row(core::RegionId region, const core::JointEffect& effect) {
  const auto& drive = effect.setpoint.drive;
  const auto numbers = drive.value_or(core::JointDrive{}).numbers();
  return row(region, effect.step, kDrive, core::value_of(effect.setpoint.id),
             drive ? std::span<const double>(numbers) : std::span<const double>());
}

std::string setpoint_row(core::RegionId region, const core::StaticEffect& effect) {
  const auto& [id, to, states] = effect.setpoint;
  const std::array<double, kMoveNumbers> numbers = {to.p_WB.x(), to.p_WB.y(), to.p_WB.z(), to.q_WB.w(),
                                                    to.q_WB.x(), to.q_WB.y(), to.q_WB.z(), static_cast<double>(states)};
  return row(region, effect.step, kMove, core::value_of(id), numbers);
}

core::Setpoints as_heard_again(const core::BodyEffect& effect) {
  return {core::kRecordedClient, sequence_of(effect.setpoint.value.has_value()), 0, effect.step, {effect.setpoint}, {}};
}

core::Setpoints as_heard_again(const core::JointEffect& effect) {
  return {core::kRecordedClient, sequence_of(effect.setpoint.drive.has_value()), 0, effect.step, {}, {effect.setpoint}};
}

core::Setpoints as_heard_again(const core::StaticEffect& effect) {
  return {core::kRecordedClient, 1, 0, effect.step, {}, {}, {effect.setpoint}};
}

std::vector<core::Setpoints> read_setpoints(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line + '\n' != kSetpointsHeader) {
    throw std::runtime_error(fmt::format("{}: this is no record of setpoints", file.string()));
  }
  std::map<std::pair<core::Step, std::uint64_t>, core::Setpoints> of_state;  // one message per state and sequence
  std::vector<std::string_view> cells;
  for (std::size_t number_of_line = 2; std::getline(in, line); ++number_of_line) {
    split_cells(line, cells);
    const std::optional<core::Setpoints> read = read_row(cells);
    if (!read) {
      throw std::runtime_error(fmt::format("{}:{}: no row of setpoints: {}", file.string(), number_of_line, line));
    }
    core::Setpoints& all = of_state[{read->at_step, read->sequence}];
    all.client = read->client, all.sequence = read->sequence, all.at_step = read->at_step;
    std::ranges::copy(read->bodies, std::back_inserter(all.bodies));
    std::ranges::copy(read->joints, std::back_inserter(all.joints));
    std::ranges::copy(read->statics, std::back_inserter(all.statics));
  }
  std::vector<core::Setpoints> messages;
  for (auto& [place, one] : of_state) messages.push_back(std::move(one));
  return messages;
}

}  // namespace aurasim::records
