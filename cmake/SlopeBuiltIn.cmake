# LAMMPS with our styles in it -> build/lmp

# its target gitversion writes to another folder then
if(CMAKE_BINARY_DIR MATCHES "[ \t]")
  message(FATAL_ERROR "The path of the build folder must have no blanks, with which LAMMPS' own build "
    "does not work: another one by -B, got ${CMAKE_BINARY_DIR}")
endif()

# In the cache, where LAMMPS' own option() finds them and -D still overrides them.
# None of these packages downloads anything.
foreach(option BUILD_MPI PKG_GRANULAR PKG_MISC PKG_PLUGIN PKG_RIGID)
  set(${option} ON CACHE BOOL "LAMMPS option")
endforeach()
foreach(option BUILD_DOC BUILD_OMP BUILD_TOOLS)
  set(${option} OFF CACHE BOOL "LAMMPS option")
endforeach()

# EXCLUDE_FROM_ALL: without LAMMPS' own installation, most of which is potentials for molecules
add_subdirectory("${LAMMPS_SOURCE_DIR}/cmake" "${CMAKE_BINARY_DIR}/lammps" EXCLUDE_FROM_ALL)
add_custom_target(slope_lmp ALL DEPENDS lmp)

set_target_properties(lmp PROPERTIES
  RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}"
  INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
target_include_directories(lammps PRIVATE ${SLOPE_INCLUDES})

# A third less to compile: most of the time goes into these headers
target_precompile_headers(lammps PRIVATE <mpi.h> <algorithm> <cmath> <cstring> <map> <set>
  <string> <vector> "${LAMMPS_SOURCE_DIR}/src/pointers.h")

# Our sources are a target of their own, compiled as LAMMPS' are: a new file or flag among them
# would recompile all of LAMMPS otherwise.
if(SLOPE_SOURCES)
  add_library(slope OBJECT ${SLOPE_SOURCES})
  foreach(property CXX_STANDARD CXX_STANDARD_REQUIRED CXX_EXTENSIONS POSITION_INDEPENDENT_CODE)
    get_target_property(value lammps ${property})
    if(value)
      set_target_properties(slope PROPERTIES ${property} ${value})
    endif()
  endforeach()
  target_include_directories(slope PRIVATE $<TARGET_PROPERTY:lammps,INCLUDE_DIRECTORIES>)
  target_compile_definitions(slope PRIVATE $<TARGET_PROPERTY:lammps,COMPILE_DEFINITIONS>
    SLOPE_LAMMPS_VERSION=${SLOPE_LAMMPS_VERSION})
  target_precompile_headers(slope PRIVATE "${LAMMPS_SOURCE_DIR}/src/pointers.h")
  target_sources(lammps PRIVATE $<TARGET_OBJECTS:slope> ${SLOPE_OBJECTS})
endif()

install(TARGETS lmp RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
if(BUILD_SHARED_LIBS)
  # LAMMPS' Python module finds the library in its own folder
  install(TARGETS lammps LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(DIRECTORY "${LAMMPS_SOURCE_DIR}/python/lammps" DESTINATION "${SLOPE_DATADIR}/python"
    PATTERN "__pycache__" EXCLUDE)
  file(CREATE_LINK "../../../../${CMAKE_INSTALL_LIBDIR}/liblammps.so"
    "${CMAKE_BINARY_DIR}/links/liblammps.so" SYMBOLIC)
  install(FILES "${CMAKE_BINARY_DIR}/links/liblammps.so"
    DESTINATION "${SLOPE_DATADIR}/python/lammps")
endif()
