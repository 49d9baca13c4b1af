// Text files of a store. Every error is a BadKeys that names the file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace aurasim::security {

enum class Secrecy { kPublic, kPrivate };

std::string read_key_file(const std::filesystem::path& file);
/// Whole or not at all. kPrivate: nobody but its owner may read it, at no moment.
void write_key_file(const std::filesystem::path& file, std::string_view text, Secrecy secrecy);
/// For nobody but its owner; it must not be there.
void make_key_folder(const std::filesystem::path& folder);
/// Refuses a private key that anybody but its owner may read or write.
void check_is_private(const std::filesystem::path& file);

}  // namespace aurasim::security
