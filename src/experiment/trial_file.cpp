#include "experiment/trial_file.h"

#include <fstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "node/csv.h"

namespace aurasim::experiment {
namespace {

constexpr std::string_view kHeader =
    "pairs,series,tolerance,value,within,aura,sync,repeat,contact_step,central_step,penetration_m,relative_speed_m_s,"
    "penetration_time_ms,late,missed,thrashed,hand_offs,pulls,violations,flagged,same_bits,slow_down";
constexpr std::size_t kColumns = 22;

using Cells = std::vector<std::string_view>;

std::optional<core::Step> step_in(std::string_view cell) {
  if (cell.empty()) return std::nullopt;
  return static_cast<core::Step>(node::whole(cell));
}

std::string cell_of(const std::optional<core::Step>& step) { return step ? fmt::to_string(*step) : std::string(); }

Variant variant_in(std::string_view aura, std::string_view sync) {
  if (aura == "central") return {AuraChoice::kNone, core::SyncMode::kBounded, true};
  const auto found_aura = aura_named(aura);
  const auto found_sync = sync_named(sync);
  if (!found_aura || !found_sync)
    throw std::runtime_error(fmt::format("collisions.csv: no variant {}, {}", aura, sync));
  return {*found_aura, *found_sync, false};
}

Trial trial_in(const Cells& cells) {
  Trial t;
  const auto pairs = pair_named(cells[0]);
  if (!pairs) throw std::runtime_error(fmt::format("collisions.csv: no kind of pairs is called {}", cells[0]));
  t.pairs = *pairs;
  t.series = cells[1];
  t.tolerance = node::number(cells[2]);
  t.value = node::number(cells[3]);
  t.within = cells[4] == "1";
  t.variant = variant_in(cells[5], cells[6]);
  t.repeat = static_cast<std::uint32_t>(node::whole(cells[7]));
  if (const auto step = step_in(cells[8])) t.contact = Contact{*step, node::number(cells[10]), node::number(cells[11])};
  t.central_step = step_in(cells[9]);
  t.hand_offs = node::whole(cells[16]);
  t.pulls = node::whole(cells[17]);
  t.violations = node::whole(cells[18]);
  t.flagged = cells[19] == "1";
  t.same_bits = cells[20] == "1";
  t.slow_down = node::number(cells[21]);
  return t;
}

}  // namespace

std::string trial_header() { return std::string(kHeader) + "\n"; }

std::string trial_row(const Trial& t) {
  std::string contact = ",,";
  if (t.contact) {
    contact = fmt::format("{},{},{:.5f}", t.contact->penetration_m, t.contact->relative_speed_m_s,
                          penetration_time_s(*t.contact) * 1e3);
  }
  return fmt::format("{},{},{},{},{:d},{},{},{},{},{},{},{:d},{:d},{:d},{},{},{},{:d},{:d},{:.4f}\n", name_of(t.pairs),
                     t.series, t.tolerance, t.value, t.within, t.variant.central ? "central" : name_of(t.variant.aura),
                     t.variant.central ? "" : name_of(t.variant.sync), t.repeat,
                     t.contact ? fmt::to_string(t.contact->step) : "", cell_of(t.central_step), contact, t.late(),
                     t.missed(), t.thrashed(), t.hand_offs, t.pulls, t.violations, t.flagged, t.same_bits, t.slow_down);
}

void read_trials(const std::filesystem::path& file, const std::function<void(const Trial&)>& row) {
  node::read_csv(file, [&](const Cells& cells) {
    if (cells.size() != kColumns) throw std::runtime_error(fmt::format("{}: a row is broken", file.string()));
    row(trial_in(cells));
  });
}

std::size_t keep_whole_blocks(const std::filesystem::path& file, std::size_t block) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::uintmax_t end = 0, whole_end = 0;
  std::size_t rows = 0;
  bool known = false;
  while (std::getline(in, line) && !in.eof()) {
    end += line.size() + 1;
    if (!known && line != kHeader) break;
    if (!known) {
      known = true;
      whole_end = end;
    } else if (++rows % block == 0) {
      whole_end = end;
    }
  }
  in.close();
  if (!known) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << trial_header();
    return 0;
  }
  std::filesystem::resize_file(file, whole_end);
  return rows / block;
}

}  // namespace aurasim::experiment
