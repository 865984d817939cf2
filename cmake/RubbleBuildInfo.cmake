# Writes build_info.h (version, commit, features) into the build folder; the commit is looked up anew at every build.
# Run as a script (cmake -P) it writes the header; included, it declares the target that does so.

if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND git -c safe.directory=${SOURCE_DIR} -C ${SOURCE_DIR} rev-parse --short=12 HEAD
    OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(COMMIT unknown)
  else()
    execute_process(COMMAND git -c safe.directory=${SOURCE_DIR} -C ${SOURCE_DIR} status --porcelain --untracked-files=no OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(APPEND COMMIT "+changes")
    endif()
  endif()
  configure_file(${SOURCE_DIR}/cmake/build_info.h.in ${OUTPUT} @ONLY)  # leaves the file alone when nothing changed
  return()
endif()

set(rubble_generated_dir ${PROJECT_BINARY_DIR}/generated)
set(rubble_features "")
if(rubble_cuda)
  string(APPEND rubble_features "cuda ")
endif()
if(rubble_cuda AND RUBBLE_STRICT)
  string(APPEND rubble_features "strict ")
endif()
if(RUBBLE_QHULL_INCLUDE AND RUBBLE_QHULL_LIBRARY)
  string(APPEND rubble_features "qhull ")
endif()
if(RUBBLE_ARCH)
  string(APPEND rubble_features "march=${RUBBLE_ARCH} ")
endif()
string(STRIP "${rubble_features}" rubble_features)
add_custom_target(rubble_build_info
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DOUTPUT=${rubble_generated_dir}/build_info.h
    -DVERSION=${PROJECT_VERSION} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} "-DFEATURES=${rubble_features}"
    -P ${CMAKE_CURRENT_LIST_FILE}
  BYPRODUCTS ${rubble_generated_dir}/build_info.h
  COMMENT "Build info" VERBATIM)
