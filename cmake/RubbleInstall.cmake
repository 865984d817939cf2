# Installs the libraries, their headers, and package files for CMake (find_package(rubble), with the components cxx and c) and for
# pkg-config (rubble, rubble_c). Nothing in them names the prefix: an installed tree may be moved.

include(CMakePackageConfigHelpers)
set(rubble_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rubble)
set(rubble_needs_cuda OFF)
if(rubble_cuda AND rubble_cuda_sources AND NOT BUILD_SHARED_LIBS)
  set(rubble_needs_cuda ON)
endif()

install(TARGETS rubble EXPORT rubbleTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/rubble DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h"
  # its library is not installed
  PATTERN "mpi.h" EXCLUDE)
install(EXPORT rubbleTargets NAMESPACE rubble:: DESTINATION ${rubble_package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/rubbleConfig.cmake.in ${PROJECT_BINARY_DIR}/rubbleConfig.cmake
  INSTALL_DESTINATION ${rubble_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rubbleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rubbleConfig.cmake ${PROJECT_BINARY_DIR}/rubbleConfigVersion.cmake
  DESTINATION ${rubble_package_dir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
# rubble.pc or rubble_c.pc; the others: what users link as well.
function(rubble_install_pc rubble_pc_name rubble_pc_requires rubble_pc_libs)
  set(folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH rubble_pc_up /${folder} /)
  string(REGEX REPLACE "/$" "" rubble_pc_up ${rubble_pc_up})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/rubble.pc.in ${PROJECT_BINARY_DIR}/${rubble_pc_name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${rubble_pc_name}.pc DESTINATION ${folder})
endfunction()
if(BUILD_SHARED_LIBS)
  rubble_install_pc(rubble "tbb" "")
else()
  # a static library has no list of its own
  set(rubble_pc_static "-ltbb -lstdc++ -lm -lpthread -ldl")
  if(RUBBLE_QHULL_INCLUDE AND RUBBLE_QHULL_LIBRARY)
    string(PREPEND rubble_pc_static "-lqhull_r ")
  endif()
  if(rubble_needs_cuda)
    string(PREPEND rubble_pc_static "-lcudart_static -lrt ")
  endif()
  rubble_install_pc(rubble "" "${rubble_pc_static}")
endif()
if(TARGET rubble_cli)
  install(TARGETS rubble_cli)
endif()
if(TARGET rubble_c AND NOT SKBUILD)
  install(TARGETS rubble_c EXPORT rubbleCTargets)
  rubble_install_pc(rubble_c "" "")
  install(EXPORT rubbleCTargets NAMESPACE rubble:: DESTINATION ${rubble_package_dir})
endif()
