# lammps_version(<lammps> <variable>): the version of a LAMMPS source tree as an integer that
# grows with time, "29 Sep 2021" -> 20210929. LAMMPS itself has it only at run time.
function(lammps_version lammps variable)
  set(months Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)
  file(STRINGS "${lammps}/src/version.h" line LIMIT_COUNT 1 REGEX "#define +LAMMPS_VERSION")
  if(NOT line MATCHES "\"([0-9]+) ?([A-Z][a-z][a-z])[a-z]* ?([0-9][0-9][0-9][0-9])\"")
    message(FATAL_ERROR "${lammps}/src/version.h: no LAMMPS version in: ${line}")
  endif()
  set(day ${CMAKE_MATCH_1})
  set(year ${CMAKE_MATCH_3})
  list(FIND months ${CMAKE_MATCH_2} month)
  math(EXPR version "10000 * ${year} + 100 * (${month} + 1) + ${day}")
  set(${variable} ${version} PARENT_SCOPE)
endfunction()
