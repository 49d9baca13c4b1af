// core/bonds.h as a wire type, and back. As in codec.h.
#pragma once

#include "core/bonds.h"
#include "dds/codec.h"

namespace aurasim::wire {
class Bonds;
}  // namespace aurasim::wire

namespace aurasim::dds {

void encode(const core::Bonds& bonds, wire::Bonds& out);
Decoded<core::Bonds> decode(const wire::Bonds& in, const Expected& expected);

}  // namespace aurasim::dds
