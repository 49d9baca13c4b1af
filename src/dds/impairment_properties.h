// Reads the impairment from an XML profile: properties aurasim.impair.{delay,jitter,loss,bandwidth,reorder,discovery,
// seed} in the <propertiesPolicy> of a participant.
#pragma once

#include <string>

#include <fastdds/rtps/attributes/PropertyPolicy.h>

#include "dds/impairment.h"

namespace aurasim::dds {

/// Returns the impairment that the properties describe. If a name occurs twice, the later value counts. Throws
/// DdsError, whose text begins with `source`, for an unknown name under aurasim.impair. and for an invalid value.
Impairment impairment_in(const eprosima::fastrtps::rtps::PropertyPolicy& properties, const std::string& source);

}  // namespace aurasim::dds
