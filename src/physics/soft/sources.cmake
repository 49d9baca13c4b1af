# The soft step, as part of aurasim_physics.
set(soft_step_sources
  soft/ahead.cpp
  soft/contacts.cpp
  soft/flight.cpp
  soft/islands.cpp
  soft/joints.cpp
  soft/kept_contacts.cpp
  soft/kernel_avx2.cpp
  soft/kernel_avx512.cpp
  soft/kernel_sse2.cpp
  soft/kernels.cpp
  soft/layout.cpp
  soft/movers.cpp
  soft/patches.cpp
  soft/resting_pairs.cpp
  soft/seam_parcels.cpp
  soft/shared.cpp
  soft/shared_rows.cpp
  soft/sorted_touches.cpp
  soft/step.cpp
  soft/threads.cpp
  soft/world.cpp)

# One file for each set of instructions, chosen at run time: never in a unity build with others. Vectors are passed by
# value only within a file, so how is of no concern.
set(kernel_options -fno-math-errno -Wno-psabi)
set_source_files_properties(soft/kernel_sse2.cpp PROPERTIES COMPILE_OPTIONS "${kernel_options}"
  SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(soft/kernel_avx2.cpp PROPERTIES COMPILE_OPTIONS "${kernel_options};-mavx2"
  SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(soft/kernel_avx512.cpp PROPERTIES COMPILE_OPTIONS
  "${kernel_options};-mavx512f;-mavx512vl;-mavx512dq" SKIP_UNITY_BUILD_INCLUSION ON)
