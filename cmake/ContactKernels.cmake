# The contact law is compiled for several instruction sets; the program chooses when it starts.
# SLOPE_KERNEL_SOURCES: a source for each, below the project's folder.

set(SLOPE_KERNEL_LEVELS v2 v3 v4) # of x86-64
set(SLOPE_KERNEL_SOURCES src/contact_kernel_baseline.cpp)
foreach(level ${SLOPE_KERNEL_LEVELS})
  list(APPEND SLOPE_KERNEL_SOURCES src/contact_kernel_x86_64_${level}.cpp)
endforeach()

include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-march=x86-64-v4 SLOPE_X86_LEVELS)
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(SLOPE_X86_LEVELS OFF)
endif()

# the options of these sources, for the targets of the folder that calls it
function(set_kernel_options)
  foreach(source src/contact_kernel.cpp ${SLOPE_KERNEL_SOURCES})
    # the two parts of -ffast-math that speed up square roots and change no result
    set(options -fno-math-errno -fno-trapping-math)
    if(SLOPE_X86_LEVELS)
      list(APPEND options -DSLOPE_X86_KERNELS)
      if(source MATCHES "x86_64_(v[0-9])")
        list(APPEND options -march=x86-64-${CMAKE_MATCH_1})
      endif()
    endif()
    if(SLOPE_NATIVE)
      list(APPEND options -DSLOPE_NATIVE)
    endif()
    set_property(SOURCE "${PROJECT_SOURCE_DIR}/${source}" APPEND PROPERTY COMPILE_OPTIONS ${options})
  endforeach()
endfunction()
