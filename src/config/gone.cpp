#include "config/gone.h"

#include <algorithm>
#include <array>

namespace aurasim::config {
namespace {

constexpr std::array kGone = {
    Gone{"physics.precision", "",
         "physics computes in double precision only, and aurasim-single was removed. Take this key out"},
    Gone{"physics.origin", "",
         "Bullet's coordinates begin at the world's origin in every region, and in double precision that is accurate "
         "far "
         "out, too. Take this key out"},
    Gone{"physics.solver", "nncg",
         "this solver was removed, because piles with friction fell apart with it. Choose soft_step (the default), or "
         "sequential_impulse with preset: exact"},
    Gone{"physics.solver", "dantzig",
         "this solver was removed, because its time grew with the cube of a pile's contacts. Choose soft_step (the "
         "default), or sequential_impulse with preset: exact"},
    Gone{
        "survival.on_death", "go_on",
        "a run does not go on without the bodies of a dead node any more. Choose recover (the default: another process "
        "takes its region over, and no body is lost), or stop (the run ends)"},
};

const Gone* find(std::string_view path, std::string_view value) {
  const auto found = std::ranges::find_if(kGone, [&](const Gone& g) { return g.path == path && g.value == value; });
  return found == kGone.end() ? nullptr : &*found;
}

}  // namespace

const Gone* gone_key(std::string_view path) { return find(path, {}); }

const Gone* gone_value(std::string_view path, std::string_view value) {
  return value.empty() ? nullptr : find(path, value);
}

}  // namespace aurasim::config
