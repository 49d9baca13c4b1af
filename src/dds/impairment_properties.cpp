#include "dds/impairment_properties.h"

#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "dds/settings.h"

namespace aurasim::dds {
namespace {

constexpr std::string_view kPrefix = "aurasim.impair.";

template <class Number>
std::optional<Number> number_in(std::string_view text, Number largest) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && value >= 0 && value <= largest ? std::optional(value) : std::nullopt;  // not for NaN
}

/// One property, by the name that kPrefix is taken from.
class Property {
 public:
  Property(std::string_view source, std::string_view name, std::string_view value)
      : source_(source), name_(name), value_(value) {}

  void read(double& field, double largest) const {
    const auto value = number_in(value_, largest);
    if (!value) refuse(fmt::format("a number from 0 to {}", largest));
    field = *value;
  }
  void read(std::uint64_t& field, std::uint64_t largest) const {
    const auto value = number_in(value_, largest);
    if (!value) refuse(fmt::format("an integer from 0 to {}", largest));
    field = *value;
  }
  void read(bool& field) const {
    if (value_ != "true" && value_ != "false") refuse("true, false");
    field = value_ == "true";
  }
  [[noreturn]] void unknown() const {
    throw DdsError(
        fmt::format("{}: {}{}: unknown property, allowed: delay, jitter, loss, bandwidth, reorder, discovery, seed",
                    source_, kPrefix, name_));
  }

 private:
  [[noreturn]] void refuse(std::string_view allowed) const {
    throw DdsError(fmt::format("{}: {}{}: found \"{}\", allowed: {}", source_, kPrefix, name_, value_, allowed));
  }

  std::string_view source_, name_, value_;
};

void read(const Property& property, std::string_view name, Impairment& impairment) {
  if (name == "delay") return property.read(impairment.delay_s, kLongestDelay_s);
  if (name == "jitter") return property.read(impairment.jitter_s, kLongestDelay_s);
  if (name == "loss") return property.read(impairment.loss, 1.0);
  if (name == "bandwidth") return property.read(impairment.bandwidth_B_s, kLargestBandwidth_B_s);
  if (name == "reorder") return property.read(impairment.reorder);
  if (name == "discovery") return property.read(impairment.discovery);
  if (name == "seed") return property.read(impairment.seed, kLargestSeed);
  property.unknown();
}

}  // namespace

Impairment impairment_in(const eprosima::fastrtps::rtps::PropertyPolicy& properties, const std::string& source) {
  Impairment impairment;
  for (const auto& property : properties.properties()) {
    std::string_view name = property.name();
    if (!name.starts_with(kPrefix)) continue;
    name.remove_prefix(kPrefix.size());
    read(Property(source, name, property.value()), name, impairment);
  }
  return impairment;
}

}  // namespace aurasim::dds
