# cmake --build build --target package: a .deb for the release that it is made on, and a .tar.gz.
#
# The .deb has everything in /opt/slope, in the places of cmake --install, and links in /usr/bin:
# slope, dump2vtk, and slope-lmp, because Debian's package lammps has an lmp there.

file(STRINGS "${CMAKE_CURRENT_SOURCE_DIR}/src/slope_version.h" line REGEX "define SLOPE_VERSION ")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" CPACK_PACKAGE_VERSION "${line}")

# ID-VERSION_ID of the release, as debian-12 or ubuntu-24.04
set(release "${CMAKE_SYSTEM_NAME}")
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release lines REGEX "^(ID|VERSION_ID)=")
  string(REGEX REPLACE "(VERSION_)?ID=|\"" "" lines "${lines}")
  list(SORT lines ORDER DESCENDING) # the word, the number
  list(JOIN lines "-" release)
endif()
string(REPLACE "-" "" release_short "${release}")

execute_process(COMMAND dpkg --print-architecture OUTPUT_VARIABLE processor ERROR_QUIET
  OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  set(processor "${CMAKE_SYSTEM_PROCESSOR}")
endif()

set(CPACK_PACKAGE_NAME slope)
set(CPACK_PACKAGE_VENDOR "SLOPE")
set(CPACK_PACKAGE_CONTACT "SLOPE <root@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "slope collapses by the simple DEM model, in LAMMPS")
set(CPACK_PACKAGE_DESCRIPTION
  "lmp with the styles of SLOPE, the command slope for studies and reports, dump2vtk, cases, pages.")
set(CPACK_PACKAGE_FILE_NAME "slope-${CPACK_PACKAGE_VERSION}-${release}-${processor}")
set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_BINARY_DIR}")

# what the programs link to is found by dpkg-shlibdeps; this is for what they call
file(STRINGS "${CMAKE_CURRENT_SOURCE_DIR}/tools/packages.txt" lines)
set(needs openmpi-bin)
set(section)
foreach(line ${lines})
  if(line MATCHES "^# ([a-z]+)$")
    set(section "${CMAKE_MATCH_1}")
  elseif(section STREQUAL "tools" AND NOT line MATCHES " without: "
      AND line MATCHES "^(python3[a-z0-9.+-]*)")
    list(APPEND needs "${CMAKE_MATCH_1}")
  endif()
endforeach()
list(JOIN needs ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_FILE_NAME "${CPACK_PACKAGE_FILE_NAME}.deb")
set(CPACK_DEBIAN_PACKAGE_RELEASE "1~${release_short}") # a later Debian's is the newer one
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/prerm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_PROJECT_CONFIG_FILE "${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/config.cmake")
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_SOURCE_DIR}/cmake/package/extras.cmake")
include(CPack)
