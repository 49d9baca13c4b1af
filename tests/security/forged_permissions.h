// Keys of a name, with which its own Fast DDS believes that it may do everything, while others get its true permissions:
// what a program without the check on its own side would do.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scratch_store.h"

namespace aurasim::security {

class ForgedPermissions {
 public:
  ForgedPermissions(const ScratchStore& scratch, const std::string& name) : files(scratch.store.files_of(name)) {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    const Validity valid{now - std::chrono::hours(1), now + std::chrono::hours(1)};
    const KeyPair own = make_authority({"of its own making", "", "aurasim"}, valid);
    const Member member = *scratch.store.find(name);
    const Subject subject{member.name, name_of(member.role), "aurasim"};
    Grants all;
    for (const char* topic : {"aura", "migration", "command", "run_control"}) {
      all.publishes.push_back({topic, {"*"}});
      all.subscribes.push_back({topic, {"*"}});
    }
    const std::string forged = sign(own, permissions_document(subject, valid, all));
    const std::string genuine = text_of(files.permissions);
    // The first authority in the file gives it its name.
    files.permissions_ca = scratch.write(name + "_ca.pem", text_of(files.permissions_ca) + own.certificate);
    files.permissions = scratch.parent() / (name + "_permissions");
    if (::mkfifo(files.permissions.c_str(), 0600) != 0) throw std::runtime_error(files.permissions.string());
    writer_ = std::jthread([this, forged, genuine] {
      give(forged);   // to be checked
      give(genuine);  // to be sent to others
    });
  }

  KeyFiles files;

 private:
  /// To the next who opens the pipe, and nobody else.
  void give(const std::string& text) const {
    const int out = ::open(files.permissions.c_str(), O_WRONLY);
    if (::write(out, text.data(), text.size()) < 0) throw std::runtime_error("write");
    ::close(out);
    for (int probe = 0; (probe = ::open(files.permissions.c_str(), O_WRONLY | O_NONBLOCK)) >= 0;) {
      ::close(probe);
      std::this_thread::yield();
    }
  }

  std::jthread writer_;
};

}  // namespace aurasim::security
