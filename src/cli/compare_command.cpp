#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "records/compare.h"

namespace aurasim::cli {
namespace {

struct CompareArguments {
  std::string a, b;
  bool json = false;
};

int compare(const CompareArguments& arguments) {
  const records::Comparison c = records::compare_reports(arguments.a, arguments.b);
  if (arguments.json) {
    nlohmann::json out = {{"hashes_equal", c.hashes_equal},
                          {"first_step", c.first_step},
                          {"steps_compared", c.steps_compared},
                          {"first_difference_step", nullptr},
                          {"bodies_compared", c.bodies_compared},
                          {"bodies_in_one_only", c.bodies_in_one_only},
                          {"max_position_error_m", c.max_position_error_m},
                          {"max_rotation_error_rad", c.max_rotation_error_rad}};
    if (c.first_difference_step) out["first_difference_step"] = *c.first_difference_step;
    fmt::print("{}\n", out.dump(2));
  } else if (c.hashes_equal) {
    fmt::print("equal: {} steps{}, the same bits in every one\n", c.steps_compared,
               c.first_step > 0 ? fmt::format(" from state {} on", c.first_step) : "");
  } else {
    fmt::print(
        "different: {} steps compared, first difference in step {}; in the last state {} bodies compared, {} in "
        "one report only, largest position error {:.6g} m, rotation error {:.6g} rad\n",
        c.steps_compared, c.first_difference_step ? fmt::to_string(*c.first_difference_step) : "none",
        c.bodies_compared, c.bodies_in_one_only, c.max_position_error_m, c.max_rotation_error_rad);
  }
  return c.hashes_equal ? 0 : 1;
}

}  // namespace

void add_compare(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("compare", "are two reports of a scene the same run, bit by bit?");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("DIR_A", arguments->a, "a report")->required()->check(CLI::ExistingDirectory);
  command->add_option("DIR_B", arguments->b, "another report")->required()->check(CLI::ExistingDirectory);
  command->add_flag("--json", arguments->json, "print an object instead of a sentence");
  command->footer("Example:\n  aurasim compare four one");
  command->callback([arguments, &action] { action = [arguments] { return compare(*arguments); }; });
}

}  // namespace aurasim::cli
