// What goes in and out of worlds, as Python's classes: bodies and observations, whose arrays are seen and not copied,
// reports, errors, and what is asked for.
#pragma once

#include <pybind11/pybind11.h>

namespace aurasim::client {

void add_values(pybind11::module_& m);

}  // namespace aurasim::client
