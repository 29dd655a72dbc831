# Our styles alone -> build/slopeplugin.so. LAMMPS is not compiled: its headers are enough, if
# sizes and MPI are those of the lmp that will load it (the plugin itself checks that).

option(BUILD_MPI "MPI, or LAMMPS' serial stand-in: as in the lmp" ON)
set(LAMMPS_SIZES smallbig CACHE STRING "smallbig or bigbig: as in the lmp")
if(NOT LAMMPS_SIZES MATCHES "^(smallbig|bigbig)$")
  message(FATAL_ERROR "LAMMPS_SIZES must be smallbig or bigbig, got ${LAMMPS_SIZES}")
endif()
string(TOUPPER "${LAMMPS_SIZES}" sizes)

GenerateStyleHeaders("${CMAKE_BINARY_DIR}/styles") # of what RegisterStyles found: ours

add_library(slopeplugin MODULE src/plugin/slopeplugin.cpp ${SLOPE_SOURCES} ${SLOPE_OBJECTS})
set_target_properties(slopeplugin PROPERTIES
  PREFIX ""
  CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF # of the newest LAMMPS' headers
  LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
target_include_directories(slopeplugin PRIVATE
  ${SLOPE_INCLUDES} "${CMAKE_BINARY_DIR}/styles" "${LAMMPS_SOURCE_DIR}/src" "${LAMMPS_SOURCE_DIR}/src/GRANULAR")
target_compile_definitions(slopeplugin PRIVATE
  LAMMPS_${sizes} SLOPE_LAMMPS_VERSION=${SLOPE_LAMMPS_VERSION})
if(BUILD_MPI)
  set(MPI_CXX_SKIP_MPICXX TRUE) # as LAMMPS: without the C++ bindings of old
  find_package(MPI REQUIRED COMPONENTS CXX)
  target_link_libraries(slopeplugin PRIVATE MPI::MPI_CXX)
else()
  target_include_directories(slopeplugin PRIVATE "${LAMMPS_SOURCE_DIR}/src/STUBS")
endif()

install(TARGETS slopeplugin LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}")
