// Writes and reads text files of a key store. Every error is a BadKeys that names the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace aurasim::security {

enum class Secrecy { kPublic, kPrivate };

std::string read_key_file(const std::filesystem::path& file);
/// Writes a file whole or not at all. kPrivate: at no moment may anybody but its owner read it.
void write_key_file(const std::filesystem::path& file, std::string_view text, Secrecy secrecy);
/// Makes a folder that only its owner may use. It must not exist yet.
void make_key_folder(const std::filesystem::path& folder);
/// Throws BadKeys if anybody but the owner may read or write the private key.
void check_is_private(const std::filesystem::path& file);

}  // namespace aurasim::security
