#include "config/utf8.h"

#include <cstdint>

namespace aurasim::config {
namespace {

/// Number of bytes of the character that begins with `first`: 1 to 4, or 0 if none does.
std::size_t length_of_character(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  if (first >= 0xf0 && first < 0xf5) return 4;
  return 0;
}

bool is_control(std::uint32_t character) {
  if (character == '\t' || character == '\n' || character == '\r') return false;
  return character < 0x20 || (character >= 0x7f && character < 0xa0);
}

/// True when a character is neither a surrogate, nor beyond Unicode, nor written with more bytes than needed.
bool is_valid(std::uint32_t character, std::size_t length) {
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  return character >= kSmallest[length] && character <= 0x10ffff && (character < 0xd800 || character > 0xdfff);
}

}  // namespace

std::size_t first_unprintable(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t length = length_of_character(first);
    if (length == 0 || at + length > text.size()) return at;
    std::uint32_t character = length == 1 ? first : first & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
      const auto next = static_cast<unsigned char>(text[at + i]);
      if ((next & 0xc0) != 0x80) return at;
      character = character << 6 | (next & 0x3f);
    }
    if (is_control(character) || !is_valid(character, length)) return at;
    at += length;
  }
  return at;
}

}  // namespace aurasim::config
