#include "lab/speed/states.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace aurasim::lab {
namespace {

constexpr std::string_view kHead = "state ";
constexpr int kNumbers = 13;

/// Reads a body's numbers. False if their count is wrong.
bool read_body(const char* text, const SpeedScene& all, core::BodyRecord& body) {
  char* end = nullptr;
  const unsigned long long id = std::strtoull(text, &end, 10);
  if (end == text || id >= all.scene.bodies.size()) return false;
  double x[kNumbers];
  for (double& value : x) {
    text = end;
    value = std::strtod(text, &end);
    if (end == text) return false;
  }
  body.id = core::BodyId{id};
  body.prototype = all.scene.bodies[id].prototype;
  body.birth = all.births[id];
  body.p_WB = {x[0], x[1], x[2]};
  body.R_WB = core::Quat(x[3], x[4], x[5], x[6]).normalized().toRotationMatrix();
  body.v_WB = {x[7], x[8], x[9]};
  body.w_WB = {x[10], x[11], x[12]};
  return true;
}

}  // namespace

void write_state(std::ostream& out, core::Step step, std::span<const core::BodyRecord> bodies) {
  out << kHead << step << '\n';
  for (const core::BodyRecord& body : bodies) {
    const core::Quat q(body.R_WB);
    out << fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {}\n", core::value_of(body.id), body.p_WB.x(),
                       body.p_WB.y(), body.p_WB.z(), q.w(), q.x(), q.y(), q.z(), body.v_WB.x(), body.v_WB.y(),
                       body.v_WB.z(), body.w_WB.x(), body.w_WB.y(), body.w_WB.z());
  }
}

std::vector<SeenState> read_states(const std::filesystem::path& file, const SpeedScene& scene) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::vector<SeenState> states;
  int line = 0;
  for (std::string text; std::getline(in, text);) {
    ++line;
    if (text.starts_with(kHead)) {
      states.push_back({std::strtoll(text.c_str() + kHead.size(), nullptr, 10), {}});
      continue;
    }
    if (states.empty() || !read_body(text.c_str(), scene, states.back().bodies.emplace_back())) {
      throw std::runtime_error(fmt::format("{}:{}: found no state of a body of {}", file.string(), line, scene.name));
    }
  }
  if (states.empty()) throw std::runtime_error(fmt::format("{}: found no state", file.string()));
  return states;
}

}  // namespace aurasim::lab
