#include "command_line/manual.h"

#include <cctype>

#include <fmt/format.h>

#include "command_line/command_line.h"

namespace aurasim::command_line {
namespace {

/// The text without macros, and without hyphens that man may break.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
      out += c;
    }
  }
  return out;
}

std::string option_entry(const CLI::Option& option) {
  std::string text = ".TP\n\\fB" + plain(name_of(option)) + "\\fR";
  if (!option.get_positional() && option.get_items_expected_max() > 0) text += " " + plain(option.get_type_name());
  text += "\n" + plain(option.get_description());
  if (!option.get_default_str().empty()) text += plain(" (" + option.get_default_str() + ")");
  return text + "\n";
}

std::string usage_of(const CLI::App& app, const std::string& path) {
  std::string text = "\\fB" + plain(path) + "\\fR";
  for (const CLI::Option* option : options_of(app)) {
    if (option->get_positional()) text += " " + plain(name_of(*option));
  }
  return text + (commands_of(app).empty() ? " [OPTION ...]" : " COMMAND");
}

std::string command_entries(const CLI::App& app, const std::string& path) {
  std::string text =
      fmt::format(".SS {}\n{}.\n.PP\n{}\n", plain(path), plain(app.get_description()), usage_of(app, path));
  for (const CLI::Option* option : options_of(app)) {
    if (name_of(*option) != "--help") text += option_entry(*option);
  }
  if (!app.get_footer().empty()) text += fmt::format(".PP\n.nf\n{}\n.fi\n", plain(app.get_footer()));
  for (const CLI::App* command : commands_of(app)) text += command_entries(*command, path + " " + command->get_name());
  return text;
}

constexpr const char* kEnd = R"(.SH EXIT STATUS
.TP
0
all well
.TP
1
something broke, a node died or a body was lost (bodies are counted only with \-\-report)
.TP
2
a file or the command line is wrong
.TP
3
refused: a neighbour did not come in time, or a run that does not agree with this one is in the same DDS domain
.TP
4
another process has taken this node's region over while it was cut off or held up
.TP
5
physics broke down for a body, which was taken out and named, and the rest went on
.TP
6
the run came to its end, but none of the worlds that \-\-save\-every was to save is whole
.TP
7
of a node: the run has ended, because another region's node has died and nobody takes it over
)";

}  // namespace

std::string manual_page(const CLI::App& program, const std::string& about) {
  const std::string name = program.get_name();
  std::string upper = name, does = program.get_description();
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (!does.empty()) does[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(does[0])));
  if (!does.empty() && does.back() == '.') does.pop_back();
  std::string text = fmt::format(".TH {} 1\n.SH NAME\n{} \\- {}\n", plain(upper), plain(name), plain(does));
  text += fmt::format(
      ".SH SYNOPSIS\n\\fB{}\\fR COMMAND [OPTION ...]\n.SH DESCRIPTION\n{}\n"
      "A launch FILE is a path, or the name of one that comes with the program, such as demo.\n.SH COMMANDS\n",
      plain(name), plain(about));
  for (const CLI::App* command : commands_of(program)) {
    text += command_entries(*command, name + " " + command->get_name());
  }
  return text + kEnd;
}

void add_manual(CLI::App& program, Action& action, const std::string& about) {
  CLI::App* command = program.add_subcommand("manual", "print the manual page, for man");
  command->footer(fmt::format("Example:\n  {} manual | man -l -", program.get_name()));
  command->callback([about, &program, &action] {
    action = [about, &program] {
      fmt::print("{}", manual_page(program, about));
      return 0;
    };
  });
}

}  // namespace aurasim::command_line
