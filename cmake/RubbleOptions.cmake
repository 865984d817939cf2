# Compiler settings: one interface target for everything that is ours, one more for the engine's own objects.

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  find_program(RUBBLE_CCACHE ccache DOC "Compiler cache, used where it is found")
  if(RUBBLE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # with these two it takes precompiled headers
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${RUBBLE_CCACHE})
    set(CMAKE_CUDA_COMPILER_LAUNCHER ${RUBBLE_CCACHE})
  endif()
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

# One set of objects serves programs and the C library. Hidden symbols keep position-independent code as fast as any other.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT BUILD_SHARED_LIBS)
  set(CMAKE_CXX_VISIBILITY_PRESET hidden)
  set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
endif()

# Precompiled headers: those of the standard library and those given. None of ours: GCC knows a header with `#pragma once` again by
# the time of its last change, and a compiler cache may bring a precompiled one from before it.
option(RUBBLE_PRECOMPILE "Precompile headers that many files include" ON)
function(rubble_precompile target)
  if(RUBBLE_PRECOMPILE)
    set(headers <algorithm> <array> <cmath> <functional> <memory> <numbers> <optional> <span> <string> <utility> <variant> <vector> ${ARGN})
    list(TRANSFORM headers REPLACE "(.+)" "$<$<COMPILE_LANGUAGE:CXX>:\\1>")
    target_precompile_headers(${target} PRIVATE ${headers})
  endif()
endfunction()

# What waits for the engine, whose own objects are optimised, compiles in two thirds of the time without; with sanitizers in half.
function(rubble_compile_quickly target)
  target_compile_options(${target} PRIVATE
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Release>>:-O1> $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Sanitize>>:-O0>)
endfunction()

# Sources of a target in groups, each compiled as one: what they include is compiled once. A change of one file compiles its group.
# Names without linkage must differ within a target then. RUBBLE_UNITY does so with nearly everything, for builds that nobody edits.
option(RUBBLE_UNITY "Compile sources in groups of ten" OFF)
function(rubble_unite target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
  # GCC takes a group for a file that others include, whose types must not use those without linkage
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
endfunction()

add_library(rubble_warnings INTERFACE)
# No build contracts products and sums, or results would depend on the processor.
target_compile_options(rubble_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)
# -Wno-psabi: lanes are wider than a baseline register, and no function that takes them by value is called from elsewhere.
target_compile_options(rubble_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wconversion -Wno-psabi>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12\\.")
  # GCC bug 105651: GCC 12 takes "text" + std::string for an overlapping copy.
  target_compile_options(rubble_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
endif()

# The compilers of Debian 12, which every change is built with. Newer ones may know warnings that nobody has seen yet.
set(rubble_werror ${RUBBLE_WERROR})
if(RUBBLE_WERROR STREQUAL "AUTO")
  set(rubble_werror OFF)
  if((CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12\\.")
     OR (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^14\\."))
    set(rubble_werror ${PROJECT_IS_TOP_LEVEL})
  endif()
endif()
if(rubble_werror)
  # GCC's flow warnings depend on the optimiser and misfire under sanitizers: they stay warnings.
  target_compile_options(rubble_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Werror>
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-Wno-error=maybe-uninitialized -Wno-error=array-bounds
      -Wno-error=stringop-overflow -Wno-error=restrict -Wno-error=free-nonheap-object>)
endif()

# Engine objects. No fast-math: contraction is off so that every build rounds alike, and the two -fno- flags change no result,
# they only free the compiler from keeping errno and floating-point traps (sqrt becomes one instruction, branches become masks).
# Release is -O3.
add_library(rubble_engine_flags INTERFACE)
target_compile_options(rubble_engine_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off -fno-math-errno -fno-trapping-math>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${BUILD_SHARED_LIBS}>>:-fno-semantic-interposition>)
if(RUBBLE_ARCH)
  target_compile_options(rubble_engine_flags INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-march=${RUBBLE_ARCH}>)
endif()
