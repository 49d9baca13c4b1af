#include <fcntl.h>
#include <unistd.h>

#include "agent/agent.h"
#include "cli/commands.h"
#include "command_line/leave.h"

namespace aurasim::cli {
namespace {

/// Child processes must not keep the client's socket open.
int take_socket() {
  const int socket = ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  ::dup2(nothing, STDIN_FILENO);
  return socket;
}

int serve_client() {
  const int socket = take_socket();
  agent::Agent agent(socket);
  command_line::leave_after([&agent] {
    agent.serve();
    return command_line::ExitCode::kOk;
  });
}

}  // namespace

/// For client libraries, which start it: nothing that people type.
void add_agent(CLI::App& program, command_line::Action& action) {
  CLI::App* command = program.add_subcommand("agent", "speak DDS for a client library, on standard input")->group("");
  command->callback([&action] { action = serve_client; });
}

}  // namespace aurasim::cli
