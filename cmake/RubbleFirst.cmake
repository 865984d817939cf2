# The first picture: a program that `./dev demo` builds and runs before all others, from the parts of the libraries that one picture
# of a pile takes. Such a part is the object library LIBRARY_first, whose objects LIBRARY has too, so nothing is compiled twice.
# In a build that cannot draw, the program says what is missing.

# What the library has that no pile takes; other libraries name what it takes.
set(rubble_not_first convex_parts fracture lattice_sides mesh_distance mesh_objects rod soft_builders solid_cut tetrahedralize
  drop_behind program socket team debug_draw joint_arrays joint_types query ray_arrays result sensors snapshot_bytes worlds_arrays
  worlds_values value_path)

# Moves the objects of these sources of a library into its part.
function(rubble_compile_first library)
  get_target_property(others ${library} SOURCES)
  list(REMOVE_ITEM others ${ARGN})
  set_target_properties(${library} PROPERTIES SOURCES "${others}")
  add_library(${library}_first OBJECT ${ARGN})
  target_sources(${library} PRIVATE $<TARGET_OBJECTS:${library}_first>)
  target_include_directories(${library}_first PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src ${rubble_generated_dir})
  target_link_libraries(${library}_first PRIVATE rubble_warnings)
endfunction()

# The program. It compiles the sources that know which cores there are itself: it has the one in float alone.
function(rubble_add_first_picture)
  set(parts rubble_first rubble_core_f32 rubble_scenes_first rubble_io_first rubble_render_first)
  list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
  add_executable(first_picture ${PROJECT_SOURCE_DIR}/apps/first_picture/main.cpp ${rubble_choosing_sources} ${objects})
  set_target_properties(first_picture PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR} EXCLUDE_FROM_ALL ON)
  target_include_directories(first_picture PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(first_picture PRIVATE rubble_warnings rubble_threads)
  foreach(package rubble::qhull PNG::PNG PkgConfig::EPOXY PkgConfig::EGL)
    if(TARGET ${package})
      target_link_libraries(first_picture PRIVATE ${package})
    endif()
  endforeach()
endfunction()
