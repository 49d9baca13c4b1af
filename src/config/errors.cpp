#include "config/errors.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/launch.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostEntries = 200;
constexpr std::size_t kLongestQuote = 80;

}  // namespace

BadConfig::BadConfig(std::vector<std::string> errors)
    : std::runtime_error(fmt::format("{}", fmt::join(errors, "\n"))), errors_(std::move(errors)) {}

std::uint32_t Errors::add_source(std::string name) {
  sources_.push_back(std::move(name));
  return static_cast<std::uint32_t>(sources_.size() - 1);
}

void Errors::add(const Place& place, std::string_view field, std::string_view message) {
  ++count_;
  if (entries_.size() >= kMostEntries) return;
  std::string text = sources_.at(place.source);
  if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
  text += fmt::format(": {}: {}", field.empty() ? "the file" : field, message);
  entries_.push_back({place, std::move(text)});
}

void Errors::throw_if_any() const {
  if (empty()) return;
  std::vector<Entry> sorted = entries_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.place.source, a.place.line, a.place.column) <
           std::tie(b.place.source, b.place.line, b.place.column);
  });
  std::vector<std::string> texts;
  for (Entry& entry : sorted) texts.push_back(std::move(entry.text));
  if (count_ > texts.size()) {
    texts.push_back(fmt::format("{}: {} more errors are not shown", sources_.front(), count_ - texts.size()));
  }
  throw BadConfig(std::move(texts));
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, kLongestQuote)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  if (text.size() > kLongestQuote) out += "...";
  return out + "\"";
}

}  // namespace aurasim::config
