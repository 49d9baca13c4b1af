#include "lab/trial_file.h"

#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "records/csv.h"

namespace aurasim::lab {
namespace {

/// A trial as it is in the file.
struct TrialRow {
  std::string_view pairs, series;
  double tolerance = 0, value = 0;
  bool within = false;
  std::string_view aura, sync;
  std::uint32_t repeat = 0;
  std::optional<core::Step> contact_step, central_step;
  std::optional<double> penetration_m, relative_speed_m_s, penetration_time_ms;
  bool late = false, missed = false, thrashed = false;
  std::uint64_t hand_offs = 0, pulls = 0, violations = 0;
  bool flagged = false, same_bits = false;
  double slow_down = 1;

  static constexpr auto columns() {
    using records::Column;
    return std::tuple{Column{"pairs", &TrialRow::pairs},
                      Column{"series", &TrialRow::series},
                      Column{"tolerance", &TrialRow::tolerance},
                      Column{"value", &TrialRow::value},
                      Column{"within", &TrialRow::within},
                      Column{"aura", &TrialRow::aura},
                      Column{"sync", &TrialRow::sync},
                      Column{"repeat", &TrialRow::repeat},
                      Column{"contact_step", &TrialRow::contact_step},
                      Column{"central_step", &TrialRow::central_step},
                      Column{"penetration_m", &TrialRow::penetration_m},
                      Column{"relative_speed_m_s", &TrialRow::relative_speed_m_s},
                      Column{"penetration_time_ms", &TrialRow::penetration_time_ms, "{:.5f}"},
                      Column{"late", &TrialRow::late},
                      Column{"missed", &TrialRow::missed},
                      Column{"thrashed", &TrialRow::thrashed},
                      Column{"hand_offs", &TrialRow::hand_offs},
                      Column{"pulls", &TrialRow::pulls},
                      Column{"violations", &TrialRow::violations},
                      Column{"flagged", &TrialRow::flagged},
                      Column{"same_bits", &TrialRow::same_bits},
                      Column{"slow_down", &TrialRow::slow_down, "{:.4f}"}};
  }
};

constexpr std::string_view kCentral = "central";

Variant variant_in(std::string_view aura, std::string_view sync) {
  if (aura == kCentral) return {AuraChoice::kNone, core::SyncMode::kBounded, true};
  const auto found_aura = aura_named(aura);
  const auto found_sync = core::sync_named(sync);
  if (!found_aura || !found_sync)
    throw std::runtime_error(fmt::format("collisions.csv: no variant {}, {}", aura, sync));
  return {*found_aura, *found_sync, false};
}

Trial trial_in(const TrialRow& row) {
  Trial t;
  const auto pairs = pair_named(row.pairs);
  if (!pairs) throw std::runtime_error(fmt::format("collisions.csv: no kind of pairs is called {}", row.pairs));
  t.pairs = *pairs;
  t.series = row.series;
  t.tolerance = row.tolerance;
  t.value = row.value;
  t.within = row.within;
  t.variant = variant_in(row.aura, row.sync);
  t.repeat = row.repeat;
  if (row.contact_step) {
    t.contact = Contact{*row.contact_step, row.penetration_m.value_or(0), row.relative_speed_m_s.value_or(0)};
  }
  t.central_step = row.central_step;
  t.hand_offs = row.hand_offs;
  t.pulls = row.pulls;
  t.violations = row.violations;
  t.flagged = row.flagged;
  t.same_bits = row.same_bits;
  t.slow_down = row.slow_down;
  return t;
}

TrialRow row_of(const Trial& t) {
  TrialRow row;
  row.pairs = name_of(t.pairs);
  row.series = t.series;
  row.tolerance = t.tolerance;
  row.value = t.value;
  row.within = t.within;
  row.aura = t.variant.central ? kCentral : name_of(t.variant.aura);
  row.sync = t.variant.central ? std::string_view() : name_of(t.variant.sync);
  row.repeat = t.repeat;
  if (t.contact) {
    row.contact_step = t.contact->step;
    row.penetration_m = t.contact->penetration_m;
    row.relative_speed_m_s = t.contact->relative_speed_m_s;
    row.penetration_time_ms = penetration_time_s(*t.contact) * 1e3;
  }
  row.central_step = t.central_step;
  row.late = t.late();
  row.missed = t.missed();
  row.thrashed = t.thrashed();
  row.hand_offs = t.hand_offs;
  row.pulls = t.pulls;
  row.violations = t.violations;
  row.flagged = t.flagged;
  row.same_bits = t.same_bits;
  row.slow_down = t.slow_down;
  return row;
}

}  // namespace

std::string trial_header() { return records::csv_header<TrialRow>(); }

std::string trial_row(const Trial& trial) { return records::csv_line(row_of(trial)); }

void read_trials(const std::filesystem::path& file, const std::function<void(const Trial&)>& row) {
  const std::size_t broken = records::read_csv<TrialRow>(file, [&](const TrialRow& r) { row(trial_in(r)); });
  if (broken > 0) throw std::runtime_error(fmt::format("{}: {} broken rows", file.string(), broken));
}

std::size_t keep_whole_blocks(const std::filesystem::path& file, std::size_t block) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::uintmax_t end = 0, whole_end = 0;
  std::size_t rows = 0;
  bool known = false;
  while (std::getline(in, line) && !in.eof()) {
    end += line.size() + 1;
    if (!known && line + '\n' != trial_header()) break;
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

}  // namespace aurasim::lab
