#include "messages/type_tables.h"

#include <fastrtps/types/DynamicDataFactory.h>
#include <fastrtps/types/DynamicTypeBuilderFactory.h>
#include <fastrtps/types/TypeObjectFactory.h>

#include "aurasimTypeObject.h"

namespace aurasim::messages {

void set_type_tables_up() {
  [[maybe_unused]] static const bool done = [] {
    eprosima::fastrtps::types::TypeObjectFactory::get_instance();
    eprosima::fastrtps::types::DynamicTypeBuilderFactory::get_instance();
    eprosima::fastrtps::types::DynamicDataFactory::get_instance();
    registeraurasimTypes();
    return true;
  }();
}

}  // namespace aurasim::messages
