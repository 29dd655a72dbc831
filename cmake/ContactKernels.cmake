# Options of the sources that compute most. The contact law is compiled for several instruction sets; the program chooses
# when it starts.

include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-march=x86-64-v4 SLOPE_X86_LEVELS)
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(SLOPE_X86_LEVELS OFF)
endif()

# the two parts of -ffast-math that speed up square roots and change no result
set(roots -fno-math-errno -fno-trapping-math)
set_property(SOURCE ${SLOPE_slips_FREE} APPEND PROPERTY COMPILE_OPTIONS ${roots})
foreach(source ${SLOPE_contacts_FREE})
  if(NOT source MATCHES "contact_kernel")
    continue()
  endif()
  set(options ${roots})
  if(SLOPE_X86_LEVELS)
    list(APPEND options -DSLOPE_X86_KERNELS)
    if(source MATCHES "x86_64_(v[0-9])")
      list(APPEND options -march=x86-64-${CMAKE_MATCH_1})
    endif()
  endif()
  if(SLOPE_NATIVE)
    list(APPEND options -DSLOPE_NATIVE)
  endif()
  set_property(SOURCE "${source}" APPEND PROPERTY COMPILE_OPTIONS ${options})
endforeach()
