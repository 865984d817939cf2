# Installs the library, its headers and a package file, so that find_package(rubble) gives the target rubble::rubble.

include(CMakePackageConfigHelpers)
set(rubble_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rubble)
set(rubble_needs_cuda OFF)
if(rubble_cuda AND rubble_cuda_sources AND NOT BUILD_SHARED_LIBS)
  set(rubble_needs_cuda ON)
endif()

install(TARGETS rubble EXPORT rubbleTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/rubble DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(EXPORT rubbleTargets NAMESPACE rubble:: DESTINATION ${rubble_package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/rubbleConfig.cmake.in ${PROJECT_BINARY_DIR}/rubbleConfig.cmake
  INSTALL_DESTINATION ${rubble_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rubbleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rubbleConfig.cmake ${PROJECT_BINARY_DIR}/rubbleConfigVersion.cmake
  DESTINATION ${rubble_package_dir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET rubble_cli)
  install(TARGETS rubble_cli)
endif()
if(TARGET rubble_c AND NOT SKBUILD)
  install(TARGETS rubble_c EXPORT rubbleCTargets)
  install(EXPORT rubbleCTargets NAMESPACE rubble:: DESTINATION ${rubble_package_dir})
endif()
