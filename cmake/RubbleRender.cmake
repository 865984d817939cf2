# Pictures and films: OpenGL through libepoxy and EGL, text and plots through Cairo. Each is left out where its package is missing.
# RUBBLE_HAS_GL and RUBBLE_HAS_CAIRO say what is in.

find_package(PkgConfig)
if(PkgConfig_FOUND)
  pkg_check_modules(EPOXY IMPORTED_TARGET epoxy)
  pkg_check_modules(EGL IMPORTED_TARGET egl)
  pkg_check_modules(CAIRO IMPORTED_TARGET cairo)
endif()
option(RUBBLE_GL "Draw with OpenGL where libepoxy, EGL and libpng are found" ON)
set(rubble_gl OFF)
if(RUBBLE_GL AND EPOXY_FOUND AND EGL_FOUND AND PNG_FOUND)
  set(rubble_gl ON)
endif()

file(GLOB render_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/render/*.cpp)
file(GLOB render_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/render/*.h)
file(GLOB render_shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/render/shaders/*)
set(render_gl_files gl.cpp box_raster.cpp screen_pass.cpp headless.cpp bodies.cpp bodies_poses.cpp surfaces.cpp lines.cpp stage_follow.cpp shadow.cpp renderer.cpp shape_meshes.cpp stage.cpp)
if(NOT rubble_gl)
  list(TRANSFORM render_gl_files PREPEND ${PROJECT_SOURCE_DIR}/render/)
  list(REMOVE_ITEM render_sources ${render_gl_files})
endif()

if(NOT CAIRO_FOUND)
  list(FILTER render_sources EXCLUDE REGEX "/render/(canvas|plot|plot_axis|plot_panel)\\.cpp$")
endif()

# The shaders travel in the program as text.
set(shader_cases "")
foreach(shader IN LISTS render_shaders)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${shader})
  get_filename_component(shader_name ${shader} NAME)
  file(READ ${shader} shader_content)
  string(APPEND shader_cases "  if (file == \"${shader_name}\") return R\"glsl(${shader_content})glsl\";\n")
endforeach()
file(CONFIGURE OUTPUT ${rubble_generated_dir}/shader_text.cpp @ONLY CONTENT
"#include \"render/shader_text.h\"

#include <rubble/error.h>

namespace rubble::render {

std::string shaderText(const std::string& file) {
@shader_cases@  throw Error(\"shader\", \"a file of render/shaders\", file);
}

}  // namespace rubble::render
")

set(shader_text ${rubble_generated_dir}/shader_text.cpp)
add_library(rubble_render STATIC ${render_sources} ${render_headers} ${shader_text})
set_target_properties(rubble_render PROPERTIES EXCLUDE_FROM_ALL ON)  # built where a program or a test needs it
target_include_directories(rubble_render PUBLIC ${PROJECT_SOURCE_DIR} PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(rubble_render PUBLIC rubble_io rubble_scenes PRIVATE rubble_warnings)
if(rubble_gl)
  target_link_libraries(rubble_render PUBLIC PkgConfig::EPOXY PkgConfig::EGL)
  target_compile_definitions(rubble_render PUBLIC RUBBLE_HAS_GL=1)
endif()
set(first painter)
if(rubble_gl)
  list(APPEND first bodies bodies_poses box_raster camera geometry gl headless lines palette renderer screen_pass shadow shape_meshes
    stage surfaces)
endif()
list(TRANSFORM first REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/render/\\1.cpp")
rubble_compile_first(rubble_render ${first} ${shader_text})
target_compile_definitions(rubble_render_first PRIVATE
  $<$<BOOL:${rubble_gl}>:RUBBLE_HAS_GL=1> $<$<BOOL:${CAIRO_FOUND}>:RUBBLE_HAS_CAIRO=1>)
if(rubble_gl)
  target_link_libraries(rubble_render_first PRIVATE PkgConfig::EPOXY PkgConfig::EGL)
endif()
rubble_add_first_picture()
if(rubble_gl AND rubble_cuda)
  # Poses go from the CUDA device to OpenGL without a copy to the host.
  target_sources(rubble_render PRIVATE ${PROJECT_SOURCE_DIR}/render/cuda_pose_feed.cu)
  target_compile_definitions(rubble_render PRIVATE RUBBLE_HAS_POSE_FEED=1)
  target_compile_options(rubble_render PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings --expt-relaxed-constexpr>)
  target_link_libraries(rubble_render PRIVATE CUDA::cudart_static)
endif()
if(CAIRO_FOUND)
  target_link_libraries(rubble_render PRIVATE PkgConfig::CAIRO)
  target_compile_definitions(rubble_render PUBLIC RUBBLE_HAS_CAIRO=1)
endif()

# The window: GLFW and Dear ImGui.
find_package(glfw3 QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(IMGUI IMPORTED_TARGET imgui)
endif()
set(rubble_viewer OFF)
if(rubble_gl AND glfw3_FOUND AND IMGUI_FOUND)
  set(rubble_viewer ON)
  file(GLOB viewer_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/apps/viewer/*.cpp)
  add_library(rubble_viewer STATIC ${viewer_sources})
  target_include_directories(rubble_viewer PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(rubble_viewer PUBLIC rubble_render PRIVATE PkgConfig::IMGUI glfw rubble_warnings)
  target_compile_definitions(rubble_viewer PUBLIC RUBBLE_HAS_VIEWER=1)
  if(RUBBLE_UNITY)
    rubble_unite(rubble_viewer)
  endif()
endif()
