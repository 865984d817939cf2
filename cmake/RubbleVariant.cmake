# The step in float once more for AVX2, beside the one for the baseline: WorldOptions::instructionSet chooses at run time.
#
# Both have the same templates, inline functions and types, and so the same symbols. A linker keeps one definition of a name, and
# could give a baseline caller one with instructions that its processor lacks. Therefore the object of the variant is linked into
# itself and all its code, vtables and constants become local (variant_object.cmake): stepAvx2() is the only name for others.
# Variables stay shared, since both cores must see the same ones. tests/backend/variant_symbols_test.py holds the object to this.

set(RUBBLE_AVX2 AUTO CACHE STRING "Compile the step for AVX2 too: AUTO (x86-64 with ELF, optimised, no RUBBLE_ARCH), ON, OFF")
set_property(CACHE RUBBLE_AVX2 PROPERTY STRINGS AUTO ON OFF)

set(rubble_avx2 ${RUBBLE_AVX2})
if(RUBBLE_AVX2 STREQUAL "AUTO")
  set(rubble_avx2 OFF)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 8
     AND CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang)$" AND CMAKE_BUILD_TYPE MATCHES "^Rel" AND CMAKE_LINKER AND CMAKE_NM AND CMAKE_OBJCOPY
     AND NOT RUBBLE_ARCH AND NOT RUBBLE_CHECKED AND NOT CMAKE_CROSSCOMPILING)
    execute_process(COMMAND ${CMAKE_LINKER} --help OUTPUT_VARIABLE help ERROR_QUIET)
    if(help MATCHES "--force-group-allocation")
      set(rubble_avx2 ON)
    endif()
  endif()
endif()

if(rubble_avx2)
  add_library(rubble_step_avx2 OBJECT ${PROJECT_SOURCE_DIR}/src/backend/cpu/cpu_step.cpp)
  target_compile_definitions(rubble_step_avx2 PRIVATE RUBBLE_CORE=f32 RUBBLE_REAL=float RUBBLE_AVX2)
  target_compile_options(rubble_step_avx2 PRIVATE -mavx2 -fno-lto $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
  target_link_libraries(rubble_step_avx2 PRIVATE rubble_common)
  set(rubble_avx2_object ${PROJECT_BINARY_DIR}/step_avx2${CMAKE_CXX_OUTPUT_EXTENSION})
  add_custom_command(OUTPUT ${rubble_avx2_object}
    COMMAND ${CMAKE_COMMAND} -DIN=$<TARGET_OBJECTS:rubble_step_avx2> -DOUT=${rubble_avx2_object} -DENTRY=stepAvx2
      -DLINKER=${CMAKE_LINKER} -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY} -P ${PROJECT_SOURCE_DIR}/cmake/variant_object.cmake
    DEPENDS rubble_step_avx2 $<TARGET_OBJECTS:rubble_step_avx2> ${PROJECT_SOURCE_DIR}/cmake/variant_object.cmake VERBATIM)
  set_source_files_properties(${rubble_avx2_object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_sources(rubble PRIVATE ${rubble_avx2_object})
  target_compile_definitions(rubble PRIVATE RUBBLE_HAS_AVX2=1)
endif()
