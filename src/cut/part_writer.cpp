#include "cut/part_writer.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cut/saved_world.h"

namespace aurasim::cut {
namespace {

using namespace std::chrono_literals;

/// Number of kept worlds that stay on disk. More than one, because nodes learn at different times which of them are
/// whole.
constexpr std::size_t kKeptWhole = 2;
/// Limit of saves of one kind that neither become whole nor fail, because a region publishes no status.
constexpr std::size_t kMostOpen = 6;

/// Number of a save. It is the same on all nodes that save a world together.
std::uint64_t save_number(std::uint64_t life, std::uint64_t request, SaveKind kind, core::Step step) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15;
  const std::uint64_t asked = kind == SaveKind::kKept ? ~std::uint64_t{0} : request;
  return ((life * kOdd ^ asked) * kOdd ^ static_cast<std::uint64_t>(step)) * kOdd;
}

std::int64_t wall_clock_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

bool PartWriter::expects(core::Step step) const {
  return std::ranges::find(expected_, step, &core::Order::at_step) != expected_.end();
}

void PartWriter::write(core::WorldCut part, const config::Launch& launch, const SaveOf& of) {
  const auto order = std::ranges::find(expected_, part.step, &core::Order::at_step);
  if (order == expected_.end()) return;
  const core::Order wanted = *order;
  expected_.erase(order);
  write(std::move(part), launch, of, wanted.request == 0 ? SaveKind::kRegular : SaveKind::kAsked, wanted.request,
        std::get<core::Save>(wanted.action).file);
}

void PartWriter::write(core::WorldCut part, const config::Launch& launch, const SaveOf& of, SaveKind kind,
                       std::uint64_t request, const std::string& world) {
  SavedWorld saved{.identity = identity_of(launch),
                   .part = core::value_of(region_),
                   .parts = static_cast<std::uint32_t>(launch.regions.size()),
                   .save = save_number(of.life, request, kind, part.step),
                   .cut = std::move(part),
                   .run = of.run,
                   .saved_ms = wall_clock_ms()};
  Save save{.number = saved.save,
            .kind = kind,
            .request = request,
            .step = saved.cut.step,
            .world = world,
            .folder = kind == SaveKind::kKept ? folders_.kept.value() : folders_.saves};
  ledger_.begin(save.number);
  open_.push_back(save);
  limit_open(kind);
  writing_.push_back({save.number, std::async(std::launch::async, [save, saved = std::move(saved)]() mutable {
                        try {
                          const PartStore store(std::filesystem::absolute(save.folder));
                          save.file = store.write(save.world, saved);
                        } catch (const std::exception& error) {
                          save.error = error.what();
                        }
                        return save;
                      })});
}

bool PartWriter::is_writing(SaveKind kind) const {
  return std::ranges::any_of(writing_, [&](const Writing& one) {
    const auto save = std::ranges::find(open_, one.number, &Save::number);
    return save != open_.end() && save->kind == kind;
  });
}

std::vector<PartWriter::Written> PartWriter::progress(Clock::time_point now) {
  std::vector<Written> done;
  std::erase_if(writing_, [&](Writing& one) {
    if (one.save.wait_for(0s) != std::future_status::ready) return false;
    const Save save = one.save.get();
    const auto open = std::ranges::find(open_, save.number, &Save::number);
    ledger_.note_own(save.number, save.error.empty());
    if (open != open_.end()) {
      *open = save;
    } else {
      drop(save);  // a later world has become whole meanwhile
    }
    done.push_back({save.kind, save.request, save.step, save.file.string(), save.error});
    return true;
  });
  for (const SaveLedger::Outcome& outcome : ledger_.take_outcomes(now)) settle(outcome);
  return done;
}

void PartWriter::finish() {
  for (const Writing& one : writing_) one.save.wait();
}

void PartWriter::settle(const SaveLedger::Outcome& outcome) {
  const auto open = std::ranges::find(open_, outcome.save, &Save::number);
  if (open == open_.end()) return;
  if (outcome.fate == SaveFate::kFailed) {
    const Save failed = *open;
    open_.erase(open);
    return note_failed(failed, outcome.without);
  }
  const Save whole = *open;
  const auto is_replaced = [&](const Save& earlier) {
    return earlier.kind == whole.kind && (whole.kind != SaveKind::kAsked || earlier.world == whole.world);
  };
  for (auto earlier = open_.begin(); earlier->number != whole.number;) {
    if (!is_replaced(*earlier)) {
      ++earlier;
      continue;
    }
    ledger_.forget(earlier->number);
    if (earlier->file != whole.file) drop(*earlier);
    earlier = open_.erase(earlier);
  }
  open_.erase(std::ranges::find(open_, whole.number, &Save::number));
  note_whole(whole);
}

/// Removes earlier worlds of this name, which are not needed any more once this one is whole. In the folder of kept
/// states, an earlier process of this region may have left some, too.
void PartWriter::note_whole(const Save& whole) {
  const bool is_kept = whole.kind == SaveKind::kKept;
  std::vector<std::uint64_t> stay = {whole.number};
  for (const Save& later : open_) stay.push_back(later.number);
  if (is_kept) std::ranges::transform(whole_[SaveKind::kKept], std::back_inserter(stay), &Save::number);
  PartStore(whole.folder).remove_others(is_kept ? "" : whole.world, core::value_of(region_), stay);
  if (whole.kind == SaveKind::kAsked) return;
  const Failing before = std::exchange(failing_[whole.kind], Failing::kNo);
  if (before == Failing::kSaid) words_.push_back(fmt::format("state {} is saved again", whole.step));
  std::deque<Save>& all = whole_[whole.kind];
  std::erase_if(all, [&](const Save& earlier) { return earlier.file == whole.file || earlier.world == whole.world; });
  all.push_back(whole);
  if (whole.kind == SaveKind::kRegular) ++regular_whole_;
  if (all.size() <= (whole.kind == SaveKind::kRegular ? keep_ : kKeptWhole)) return;
  drop(all.front());
  all.pop_front();
}

/// Drops a failed save. Only one of the regions that could not write reports it, and only once until a world of this
/// kind becomes whole again.
void PartWriter::note_failed(const Save& failed, const std::vector<core::RegionId>& without) {
  drop(failed);
  if (failed.kind == SaveKind::kRegular) ++regular_failed_;
  Failing& failing = failing_[failed.kind];
  const bool is_news = failed.kind == SaveKind::kAsked || failing == Failing::kNo;
  if (failing == Failing::kNo) failing = Failing::kYes;
  if (!is_news || without.front() != region_) return;
  failing = Failing::kSaid;
  std::vector<std::uint32_t> regions;
  for (const core::RegionId region : without) regions.push_back(core::value_of(region));
  const std::string what = failed.kind == SaveKind::kKept ? "is not kept on disk (survival.disk)" : "was not saved";
  const std::string then = failed.kind == SaveKind::kAsked ? "" : " It is tried again, and said once when it works.";
  words_.push_back(
      fmt::format("state {} {}: regions [{}] could not write their parts: {}. What was saved before is "
                  "untouched.{}",
                  failed.step, what, fmt::join(regions, ", "), failed.error, then));
}

void PartWriter::limit_open(SaveKind kind) {
  if (std::ranges::count(open_, kind, &Save::kind) <= std::ptrdiff_t{kMostOpen}) return;
  const auto oldest = std::ranges::find(open_, kind, &Save::kind);
  ledger_.forget(oldest->number);
  drop(*oldest);
  open_.erase(oldest);
}

/// Removes a save's file. A folder of an earlier number of this run is removed with its last file.
void PartWriter::drop(const Save& save) {
  std::error_code ignored;
  if (!save.file.empty()) std::filesystem::remove(save.file, ignored);
  if (save.kind == SaveKind::kKept && save.folder != folders_.kept) std::filesystem::remove(save.folder, ignored);
}

}  // namespace aurasim::cut
