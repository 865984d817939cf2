# The library: host code, the CPU core once in float and once in double, and the CUDA backend.

file(GLOB rubble_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/rubble/*.h)
file(GLOB rubble_host_sources CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/src/world/*.cpp ${PROJECT_SOURCE_DIR}/src/cook/*.cpp ${PROJECT_SOURCE_DIR}/src/forces/*.cpp ${PROJECT_SOURCE_DIR}/src/backend/*.cpp
  ${PROJECT_SOURCE_DIR}/src/platform/*.cpp ${PROJECT_SOURCE_DIR}/src/math/*.cpp)
file(GLOB rubble_core_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tables/*.cpp ${PROJECT_SOURCE_DIR}/src/backend/cpu/*.cpp)
file(GLOB rubble_lockstep_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backend/lockstep/*.cpp)
file(GLOB rubble_distributed_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backend/distributed/*.cpp)
file(GLOB rubble_cuda_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backend/cuda/*.cu ${PROJECT_SOURCE_DIR}/src/backend/cuda/*.cpp)

# Tables have another layout then, which device code does not know.
if(RUBBLE_CHECKED)
  if(rubble_cuda)
    message(FATAL_ERROR "RUBBLE_CHECKED: expected a build without CUDA (-DRUBBLE_CUDA=OFF)")
  endif()
  add_compile_definitions(RUBBLE_CHECKED)
endif()

# What every part of the library is compiled with.
add_library(rubble_common INTERFACE)
target_include_directories(rubble_common INTERFACE
  ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src ${rubble_generated_dir})
target_link_libraries(rubble_common INTERFACE rubble_warnings rubble_engine_flags rubble_threads)

# An object library whose solver works in `real`; its code lives in namespace rubble::`core`.
function(rubble_add_core name core real)
  add_library(${name} OBJECT ${ARGN})
  target_compile_definitions(${name} PRIVATE RUBBLE_CORE=${core} RUBBLE_REAL=${real})
  target_link_libraries(${name} PRIVATE rubble_common)
  target_sources(rubble PRIVATE $<TARGET_OBJECTS:${name}>)
  if(RUBBLE_UNITY)
    rubble_unite(${name})
  endif()
endfunction()

add_library(rubble ${rubble_host_sources} ${rubble_headers})
add_library(rubble::rubble ALIAS rubble)
# These know which cores there are, by RUBBLE_HAS_...: another program may have others.
set(rubble_choosing_sources ${PROJECT_SOURCE_DIR}/src/world/backends.cpp ${PROJECT_SOURCE_DIR}/src/backend/cuda_support.cpp)
set(rubble_first_sources ${rubble_host_sources})
list(REMOVE_ITEM rubble_first_sources ${rubble_choosing_sources})
list(JOIN rubble_not_first "|" not_first)
list(FILTER rubble_first_sources EXCLUDE REGEX "/(${not_first})\\.cpp$")
rubble_compile_first(rubble ${rubble_first_sources})
target_link_libraries(rubble_first PRIVATE rubble_common)
add_dependencies(rubble_first rubble_build_info)
rubble_precompile(rubble_first)
rubble_unite(rubble_first)
add_dependencies(rubble rubble_build_info)
rubble_precompile(rubble)
if(RUBBLE_REFERENCE)
  target_compile_definitions(rubble PRIVATE RUBBLE_HAS_REFERENCE=1)
endif()
if(RUBBLE_UNITY)
  rubble_unite(rubble)
endif()
# it acts on the whole process, so the C library must not find it in a group
set_source_files_properties(${PROJECT_SOURCE_DIR}/src/platform/program.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
set_target_properties(rubble PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} LINKER_LANGUAGE CXX)
target_compile_features(rubble PUBLIC cxx_std_20)
target_include_directories(rubble PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rubble PRIVATE $<BUILD_INTERFACE:rubble_common> ${rubble_thread_library})

if(RUBBLE_QHULL_INCLUDE AND RUBBLE_QHULL_LIBRARY)
  target_include_directories(rubble_first SYSTEM PRIVATE ${RUBBLE_QHULL_INCLUDE})  # hull.cpp alone includes it
  target_compile_definitions(rubble_first PRIVATE RUBBLE_HAS_QHULL=1)
  # By a name that the installed package defines again, so that its files have no path of this machine.
  if(NOT TARGET rubble::qhull)
    add_library(rubble::qhull UNKNOWN IMPORTED GLOBAL)
    set_target_properties(rubble::qhull PROPERTIES IMPORTED_LOCATION ${RUBBLE_QHULL_LIBRARY})
  endif()
  target_link_libraries(rubble PRIVATE rubble::qhull)
endif()

if(rubble_core_sources)
  rubble_add_core(rubble_core_f32 f32 float ${rubble_core_sources})
  rubble_precompile(rubble_core_f32)
  if(RUBBLE_REFERENCE)
    rubble_add_core(rubble_core_f64 f64 double ${rubble_core_sources})
    rubble_precompile(rubble_core_f64)
    # the same lines as in single precision, where this sanitizer watches them
    target_compile_options(rubble_core_f64 PRIVATE $<$<CONFIG:Sanitize>:-fno-sanitize=undefined>)
  endif()
endif()
include(RubbleVariant)
if(rubble_lockstep_sources)
  rubble_add_core(rubble_lockstep f32 float ${rubble_lockstep_sources})
  target_compile_definitions(rubble PRIVATE RUBBLE_HAS_LOCKSTEP=1)
endif()
if(rubble_distributed_sources)
  rubble_add_core(rubble_distributed f32 float ${rubble_distributed_sources})
  target_compile_definitions(rubble PRIVATE RUBBLE_HAS_DISTRIBUTED=1)
  # files are written through it without a core
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/backend/distributed/transport.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endif()
if(rubble_cuda AND rubble_cuda_sources)
  rubble_add_core(rubble_core_cuda f32 float ${rubble_cuda_sources})
  set(kernel_sources ${rubble_cuda_sources})
  list(FILTER kernel_sources INCLUDE REGEX "\\.cu$")
  set_source_files_properties(${kernel_sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # CMake groups them from 3.31 on
  # A host-only call in device code is a mere warning to nvcc, and the kernel silently becomes empty: so warnings are errors.
  target_compile_options(rubble_core_cuda PRIVATE
    $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings --expt-relaxed-constexpr --extended-lambda -Xcompiler=-ffp-contract=off>)
  if(RUBBLE_STRICT)
    target_compile_definitions(rubble_core_cuda PRIVATE RUBBLE_STRICT=1)
    target_compile_options(rubble_core_cuda PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-fmad=false>)
  else()
    # In a step quotients and roots may be wrong by two units in the last place: fewer instructions, and no branch for rare numbers.
    set_source_files_properties(${PROJECT_SOURCE_DIR}/src/backend/cuda/cuda_stepper.cu ${PROJECT_SOURCE_DIR}/src/backend/cuda/tree_solver.cu
      PROPERTIES COMPILE_OPTIONS "-prec-div=false;-prec-sqrt=false")
  endif()
  target_link_libraries(rubble_core_cuda PRIVATE CUDA::cudart_static)
  target_compile_definitions(rubble PRIVATE RUBBLE_HAS_CUDA=1)
  target_link_libraries(rubble PRIVATE CUDA::cudart_static)
endif()

# Ranks as processes of MPI: a library of its own, so that the library itself needs no MPI.
if(NOT RUBBLE_MPI STREQUAL "OFF")
  find_package(MPI COMPONENTS CXX QUIET)
  if(MPI_CXX_FOUND AND rubble_distributed_sources AND NOT BUILD_SHARED_LIBS)
    file(GLOB rubble_mpi_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/backend/mpi/*.cpp)
    add_library(rubble_mpi STATIC ${rubble_mpi_sources})
    add_library(rubble::mpi ALIAS rubble_mpi)
    target_include_directories(rubble_mpi PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(rubble_mpi PUBLIC rubble PRIVATE rubble_warnings MPI::MPI_CXX)
  elseif(RUBBLE_MPI STREQUAL "ON")
    message(FATAL_ERROR "RUBBLE_MPI: expected MPI (Debian: libopenmpi-dev) and a static library")
  endif()
endif()
