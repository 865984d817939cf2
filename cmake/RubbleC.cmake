# The C library: everything in one shared library that exports rb_* alone. The Python package loads it.

file(GLOB c_api_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/c_api/*.cpp)
file(GLOB c_api_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/rubble/c/*.h ${PROJECT_SOURCE_DIR}/c_api/*.h)
add_library(rubble_c SHARED ${c_api_sources} ${c_api_headers})
add_library(rubble::rubble_c ALIAS rubble_c)
set_target_properties(rubble_c PROPERTIES LINKER_LANGUAGE CXX CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
  INSTALL_RPATH $ORIGIN)
target_compile_definitions(rubble_c PRIVATE RB_BUILDING_LIBRARY)
target_include_directories(rubble_c PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src
  PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# The libraries go through BUILD_INTERFACE, because users of the shared library need none of them.
target_link_libraries(rubble_c PRIVATE
  $<BUILD_INTERFACE:rubble_render> $<BUILD_INTERFACE:rubble_io> $<BUILD_INTERFACE:rubble_scenes>
  $<BUILD_INTERFACE:rubble> $<BUILD_INTERFACE:rubble_warnings> ${CMAKE_DL_LIBS})
if(TARGET rubble_convert)
  target_link_libraries(rubble_c PRIVATE $<BUILD_INTERFACE:rubble_convert>)
endif()
rubble_precompile(rubble_c <nlohmann/json.hpp>)
if(RUBBLE_UNITY)
  rubble_unite(rubble_c)
endif()
set(c_api_exports ${PROJECT_SOURCE_DIR}/c_api/exports.map)
target_link_options(rubble_c PRIVATE -Wl,--version-script=${c_api_exports} -Wl,--as-needed -Wl,--no-undefined
  -Wl,--gc-sections)
set_target_properties(rubble_c PROPERTIES LINK_DEPENDS ${c_api_exports})

# In a Python package (pyproject.toml) the library lies beside the modules, under one name.
if(SKBUILD)
  install(TARGETS rubble_c LIBRARY DESTINATION rubble COMPONENT python)
else()
  set_target_properties(rubble_c PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
endif()
