// How an XML profile says what is impaired: properties aurasim.impair.{delay,jitter,loss,bandwidth,reorder,discovery,
// seed} in the <propertiesPolicy> of a participant.
#pragma once

#include <string>

#include <fastdds/rtps/attributes/PropertyPolicy.h>

#include "dds/impairment.h"

namespace aurasim::dds {

/// Throws DdsError, which begins with `source`, for an unknown name under aurasim.impair. and for a value that cannot
/// be used. Of two of one name the later one counts.
Impairment impairment_in(const eprosima::fastrtps::rtps::PropertyPolicy& properties, const std::string& source);

}  // namespace aurasim::dds
