# Finds nvcc, and enables the CUDA language when the backend is wanted.
# RUBBLE_NVCC: the compiler, whether or not the backend is built (the compile check of the tests needs nothing more).
# rubble_cuda: ON when the backend is built.

find_program(RUBBLE_NVCC nvcc HINTS ENV CUDACXX ENV CUDA_HOME ENV CUDA_PATH PATH_SUFFIXES bin DOC "CUDA compiler")
find_program(RUBBLE_NVCC nvcc PATHS /usr/local/cuda/bin)

set(rubble_cuda OFF)
if(RUBBLE_CUDA STREQUAL "AUTO")
  if(RUBBLE_NVCC)
    set(rubble_cuda ON)
  endif()
elseif(RUBBLE_CUDA)
  if(NOT RUBBLE_NVCC)
    message(FATAL_ERROR "RUBBLE_CUDA=ON, but nvcc was not found. Set CUDACXX or CUDA_HOME, or install the CUDA toolkit.")
  endif()
  set(rubble_cuda ON)
endif()

if(rubble_cuda)
  if(NOT CMAKE_CUDA_COMPILER)
    set(CMAKE_CUDA_COMPILER ${RUBBLE_NVCC})
  endif()
  # CMake 3.25 would try sm_52, which CUDA 13 no longer has. One architecture for each first number: devices run the code
  # of a smaller second number (sm_86 and sm_89 that of sm_80). Those that this nvcc does not know are left out.
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
    set(CMAKE_CUDA_ARCHITECTURES 80-real 90-real 100-real 120)
  endif()
  execute_process(COMMAND ${RUBBLE_NVCC} --list-gpu-arch OUTPUT_VARIABLE known_archs OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX MATCHALL "[0-9]+" known_archs "${known_archs}")
  set(archs)
  foreach(arch IN LISTS CMAKE_CUDA_ARCHITECTURES)
    string(REGEX MATCH "^[0-9]+" number "${arch}")
    if(number STREQUAL "" OR number IN_LIST known_archs)
      list(APPEND archs ${arch})
    endif()
  endforeach()
  if(NOT archs)
    message(FATAL_ERROR "${RUBBLE_NVCC} knows none of the architectures ${CMAKE_CUDA_ARCHITECTURES}")
  endif()
  # The newest one is kept as PTX too, so that later devices can run it.
  list(TRANSFORM archs REPLACE "^([0-9]+)-real$" "\\1" AT -1)
  if(NOT archs STREQUAL CMAKE_CUDA_ARCHITECTURES)
    message(STATUS "CUDA architectures: ${archs}")
  endif()
  set(CMAKE_CUDA_ARCHITECTURES ${archs})
  enable_language(CUDA)
  find_package(CUDAToolkit REQUIRED)
  # Kernels of one file compile side by side.
  include(CheckCompilerFlag)
  check_compiler_flag(CUDA --split-compile=0 RUBBLE_NVCC_SPLITS)
  if(RUBBLE_NVCC_SPLITS)
    add_compile_options("$<$<COMPILE_LANGUAGE:CUDA>:--split-compile=0>")
  endif()
  # Device code is most of a program: half as large as by default. Drivers read it from CUDA 12.4 on.
  check_compiler_flag(CUDA --compress-mode=size RUBBLE_NVCC_COMPRESSES)
  if(RUBBLE_NVCC_COMPRESSES)
    add_compile_options("$<$<COMPILE_LANGUAGE:CUDA>:--compress-mode=size>")
  endif()
  if(NOT DEFINED CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 does not know that nvcc takes C++20
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION -std=c++20)
  endif()
endif()
