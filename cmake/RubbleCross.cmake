# Cross builds take from the machine that builds what needs no compiler or can be compiled here: the headers of JSON for Modern C++,
# CLI11, fmt and Eigen, the sources of GoogleTest (Debian: googletest), and those of qhull where RUBBLE_QHULL_SOURCE names them.

set(RUBBLE_QHULL_SOURCE "" CACHE PATH "Sources of qhull 2020.2 for cross builds (Debian: apt-get source qhull); empty: no hulls")

# /usr/include as a whole would bring the C library of the wrong system.
function(rubble_host_headers target folder)
  set(headers ${PROJECT_BINARY_DIR}/host_headers)
  if(NOT EXISTS /usr/include/${folder})
    message(FATAL_ERROR "Cross build: expected the headers /usr/include/${folder}")
  endif()
  file(MAKE_DIRECTORY ${headers})
  file(CREATE_LINK /usr/include/${folder} ${headers}/${folder} SYMBOLIC)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${headers} ${ARGN})
endfunction()

rubble_host_headers(nlohmann_json::nlohmann_json nlohmann)
rubble_host_headers(CLI11::CLI11 CLI)
rubble_host_headers(fmt::fmt fmt)
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY=1)
if(RUBBLE_TESTS)
  rubble_host_headers(Eigen3::Eigen eigen3 ${PROJECT_BINARY_DIR}/host_headers/eigen3)
  set(BUILD_GMOCK OFF)
  set(INSTALL_GTEST OFF)
  set(gtest_disable_pthreads OFF)
  add_subdirectory(/usr/src/googletest ${PROJECT_BINARY_DIR}/googletest EXCLUDE_FROM_ALL)
endif()

if(RUBBLE_QHULL_SOURCE)
  enable_language(C)
  file(GLOB qhull_sources ${RUBBLE_QHULL_SOURCE}/src/libqhull_r/*.c)
  add_library(rubble_qhull STATIC ${qhull_sources})
  target_compile_options(rubble_qhull PRIVATE -w -ffp-contract=off)
  set_target_properties(rubble_qhull PROPERTIES EXPORT_NAME qhull)
  add_library(rubble::qhull ALIAS rubble_qhull)
  set(RUBBLE_QHULL_INCLUDE ${RUBBLE_QHULL_SOURCE}/src CACHE PATH "" FORCE)
  set(RUBBLE_QHULL_LIBRARY rubble_qhull CACHE STRING "" FORCE)
endif()
