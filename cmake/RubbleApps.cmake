# What stands around the library: files, which are installed with it as rubble::io and rubble::convert, scenes and the command line
# program.

if(NOT CMAKE_CROSSCOMPILING)
  find_package(nlohmann_json REQUIRED)
  if(RUBBLE_APPS OR RUBBLE_TESTS)
    find_package(fmt REQUIRED)
    find_package(CLI11 REQUIRED)
  endif()
endif()
find_package(PNG)
find_path(RUBBLE_ZSTD_INCLUDE zstd.h)
find_library(RUBBLE_ZSTD_LIBRARY zstd)

# A static library from the sources of one folder. They include one another as "io/file.h". Installed, they do so in include/rubble.
# UNITE: in groups in all builds, where headers of others take most of the time and files are short. FIRST: files that the first
# picture takes (RubbleFirst.cmake).
function(rubble_add_library name folder)
  cmake_parse_arguments(PARSE_ARGV 2 option "UNITE" "" "FIRST")
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.h)
  add_library(${name} STATIC ${sources} ${headers})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/rubble>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${name} PUBLIC rubble::rubble PRIVATE $<BUILD_INTERFACE:rubble_warnings>)
  target_compile_options(${name} PRIVATE $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Sanitize>>:-O0>)
  if(option_FIRST)
    list(TRANSFORM option_FIRST REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/${folder}/\\1.cpp")
    rubble_compile_first(${name} ${option_FIRST})
    rubble_unite(${name}_first)
  endif()
  # scenes alike use the same names within their files
  if(option_UNITE OR (RUBBLE_UNITY AND NOT folder STREQUAL "scenes"))
    rubble_unite(${name})
  endif()
endfunction()

rubble_add_library(rubble_scenes scenes FIRST arguments build piles probes probe_parts)
rubble_compile_quickly(rubble_scenes)
rubble_compile_quickly(rubble_scenes_first)
rubble_precompile(rubble_scenes)

rubble_add_library(rubble_io io UNITE FIRST look_table output_file picture_machines picture_ropes picture_soft picture_stands
  picture_values picture_world png)
# tests/extension compiles it with other elements, and must not find it in a group
set_source_files_properties(io/picture_soft.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_link_libraries(rubble_io PUBLIC nlohmann_json::nlohmann_json)
rubble_precompile(rubble_io <nlohmann/json.hpp>)
if(PNG_FOUND)
  target_link_libraries(rubble_io PRIVATE PNG::PNG)
  target_link_libraries(rubble_io_first PRIVATE PNG::PNG)
  target_compile_definitions(rubble_io PUBLIC RUBBLE_HAS_PNG=1)
  target_compile_definitions(rubble_io_first PRIVATE RUBBLE_HAS_PNG=1)
endif()
if(RUBBLE_ZSTD_INCLUDE AND RUBBLE_ZSTD_LIBRARY)
  target_include_directories(rubble_io SYSTEM PRIVATE ${RUBBLE_ZSTD_INCLUDE})
  target_link_libraries(rubble_io PRIVATE $<BUILD_INTERFACE:${RUBBLE_ZSTD_LIBRARY}> $<INSTALL_INTERFACE:zstd>)
  target_compile_definitions(rubble_io PUBLIC RUBBLE_HAS_ZSTD=1)
endif()

# Meshes as scenes. Formats other than OBJ, STL, PLY and MSH are read by assimp where it is found; RUBBLE_HAS_ASSIMP says so.
find_path(RUBBLE_ASSIMP_INCLUDE assimp/Importer.hpp)
find_library(RUBBLE_ASSIMP_LIBRARY assimp)
rubble_add_library(rubble_meshes convert/mesh)
target_link_libraries(rubble_meshes PUBLIC rubble_io)
if(RUBBLE_ASSIMP_INCLUDE AND RUBBLE_ASSIMP_LIBRARY)
  target_include_directories(rubble_meshes SYSTEM PRIVATE ${RUBBLE_ASSIMP_INCLUDE})
  target_link_libraries(rubble_meshes PRIVATE $<BUILD_INTERFACE:${RUBBLE_ASSIMP_LIBRARY}> $<INSTALL_INTERFACE:assimp>)
  target_compile_definitions(rubble_meshes PUBLIC RUBBLE_HAS_ASSIMP=1)
endif()
rubble_precompile(rubble_meshes <nlohmann/json.hpp>)

# Layers of USD, as text and as crate files.
rubble_add_library(rubble_usd convert/usd)
target_link_libraries(rubble_usd PUBLIC rubble_io)

# Models of robots as scenes. Left out where pugixml is missing; RUBBLE_HAS_CONVERT says whether it is in.
find_package(pugixml QUIET)
if(pugixml_FOUND)
  rubble_add_library(rubble_convert convert UNITE)
  target_link_libraries(rubble_convert PUBLIC rubble_usd rubble_meshes rubble_io pugixml::pugixml)
  target_compile_definitions(rubble_convert PUBLIC RUBBLE_HAS_CONVERT=1)
  rubble_compile_quickly(rubble_convert)
  rubble_precompile(rubble_convert <nlohmann/json.hpp> <pugixml.hpp>)
endif()

# Recordings as files of other programs.
rubble_add_library(rubble_export convert/out UNITE)
target_link_libraries(rubble_export PUBLIC rubble_io)
rubble_precompile(rubble_export <nlohmann/json.hpp>)

include(RubbleRender)

# The subcommands are a library, which tests may link.
if(RUBBLE_APPS)
  rubble_add_library(rubble_commands apps/cli UNITE)
  get_target_property(sources rubble_commands SOURCES)
  list(REMOVE_ITEM sources ${PROJECT_SOURCE_DIR}/apps/cli/main.cpp)
  set_target_properties(rubble_commands PROPERTIES SOURCES "${sources}")
  target_link_libraries(rubble_commands PUBLIC rubble_render rubble_export rubble_meshes rubble_io rubble_scenes CLI11::CLI11 fmt::fmt)
  if(TARGET rubble_convert)
    target_link_libraries(rubble_commands PUBLIC rubble_convert)
  endif()
  if(rubble_viewer)
    target_link_libraries(rubble_commands PRIVATE rubble_viewer)
  endif()
  rubble_compile_quickly(rubble_commands)
  if(TARGET rubble_mpi)
    target_link_libraries(rubble_commands PUBLIC rubble_mpi)
    target_compile_definitions(rubble_commands PUBLIC RUBBLE_HAS_MPI=1)
  endif()
  rubble_precompile(rubble_commands <CLI/CLI.hpp> <fmt/format.h> <nlohmann/json.hpp>)

  add_executable(rubble_cli apps/cli/main.cpp)
  set_target_properties(rubble_cli PROPERTIES OUTPUT_NAME rubble RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}
    INSTALL_RPATH $ORIGIN/../${CMAKE_INSTALL_LIBDIR})
  target_link_libraries(rubble_cli PRIVATE rubble_commands rubble_warnings)
endif()
