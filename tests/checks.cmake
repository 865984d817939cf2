# The project's own checks as tests, so that one ctest says everything. Label checks: in any run. Label heavy: builds something first.

function(rubble_add_check name label)
  add_test(NAME check.${name} COMMAND ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(check.${name} PROPERTIES LABELS ${label} TIMEOUT 1800 SKIP_RETURN_CODE 77)
endfunction()

# A build of another preset, and what then runs in it. Builds take every core, so nothing runs beside them.
function(rubble_add_build preset label)
  rubble_add_check(build.${preset} ${label} ${CMAKE_COMMAND} -E env RUBBLE_SETUP=off ./dev build ${preset})
  set_tests_properties(check.build.${preset} PROPERTIES FIXTURES_SETUP ${preset} RUN_SERIAL ON)
  if(ARGN)
    rubble_add_check(run.${preset} ${label} ${ARGN})
    set_tests_properties(check.run.${preset} PROPERTIES FIXTURES_REQUIRED ${preset} RUN_SERIAL ON)
  endif()
endfunction()

# nvcc must take all of the engine that is shared by host and device, and every kernel of the step, whether or not the CUDA backend
# is built: as far as PTX and not optimised (-G), since what is refused or warned of is found before and the rest takes ten times
# as long.
if(RUBBLE_NVCC)
  file(GLOB core_headers RELATIVE ${PROJECT_SOURCE_DIR}/src CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/src/math/*.h ${PROJECT_SOURCE_DIR}/src/solver/*.h
    ${PROJECT_SOURCE_DIR}/src/forces/*.h ${PROJECT_SOURCE_DIR}/src/collision/*.h
    ${PROJECT_SOURCE_DIR}/src/state/*.h ${PROJECT_SOURCE_DIR}/src/stages/*.h ${PROJECT_SOURCE_DIR}/src/stages/*/*.h)
  list(TRANSFORM core_headers REPLACE "(.+)" "#include \"\\1\"")
  list(JOIN core_headers "\n" core_headers)
  file(CONFIGURE OUTPUT ${rubble_generated_dir}/core_headers.h CONTENT "#pragma once\n@core_headers@\n" @ONLY)
  set(object ${CMAKE_CURRENT_BINARY_DIR}/cuda_compile_check.ptx)
  add_custom_command(OUTPUT ${object}
    COMMAND ${RUBBLE_NVCC} -std=c++20 -G -arch=compute_90 -ptx -Werror=all-warnings --expt-relaxed-constexpr --extended-lambda
      -DRUBBLE_CORE=f32 -DRUBBLE_REAL=float
      -I${PROJECT_SOURCE_DIR}/include -I${PROJECT_SOURCE_DIR}/src -I${rubble_generated_dir}
      -MD -MF ${object}.d ${CMAKE_CURRENT_SOURCE_DIR}/cuda/compile_check.cu -o ${object}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cuda/compile_check.cu ${rubble_generated_dir}/core_headers.h
    DEPFILE ${object}.d
    COMMENT "nvcc: all that host and device share" VERBATIM)
  add_custom_target(cuda_compile_check DEPENDS ${object})
endif()

if(RUBBLE_CHECKS)
  foreach(script layers equations links pages portability sizes units words)
    rubble_add_check(${script} checks ${Python3_EXECUTABLE} tools/check_${script})
  endforeach()
  rubble_add_check(picture_of_the_step checks ${Python3_EXECUTABLE} tools/draw_step --check)
  rubble_add_check(pictures_of_the_solvers checks ${Python3_EXECUTABLE} tools/draw_solvers --check)
  rubble_add_check(page_of_performance checks ${Python3_EXECUTABLE} tools/make_performance --check)
  rubble_add_check(tools checks ${Python3_EXECUTABLE} -B -m unittest discover -s tests/tools)
  set(program_of_pages "")
  if(TARGET rubble_cli)
    set(program_of_pages $<TARGET_FILE:rubble_cli>)
  endif()
  rubble_add_check(first_picture checks ${Python3_EXECUTABLE} -B tests/packaging/first_picture_test.py ${PROJECT_BINARY_DIR})
  rubble_add_check(code_of_pages checks ${Python3_EXECUTABLE} -B tests/tools/page_code.py ${CMAKE_CXX_COMPILER}
    ${program_of_pages})
  rubble_add_check(packaging heavy bash tests/packaging/run ${PROJECT_BINARY_DIR} ${CMAKE_CXX_COMPILER})

  rubble_add_check(c_abi checks ${Python3_EXECUTABLE} tools/check_abi)
  if(TARGET rubble_c)
    rubble_add_check(c_layout checks ${Python3_EXECUTABLE} tools/check_layout $<TARGET_FILE:rubble_c>)
  endif()
  rubble_add_check(from_source long bash tests/packaging/from_source ${CMAKE_CXX_COMPILER})
  set_tests_properties(check.from_source PROPERTIES RUN_SERIAL ON TIMEOUT 7200)
  rubble_add_check(release long bash tests/packaging/release)
  set_tests_properties(check.release PROPERTIES RUN_SERIAL ON TIMEOUT 14400)

  if(RUBBLE_NVCC)
    rubble_add_check(build.cuda_compile checks ${CMAKE_COMMAND} --build ${PROJECT_BINARY_DIR} --target cuda_compile_check)
    set_tests_properties(check.build.cuda_compile PROPERTIES RUN_SERIAL ON)
  endif()
  find_program(RUBBLE_CLANG clang++)
  if(RUBBLE_CLANG)
    # Clang, with its warnings and its bits: what it builds is fuzzed for a minute a target, always by the same seed
    rubble_add_build(fuzz-fast heavy tools/fuzz --fast --seconds 60 --seed 1)
    rubble_add_check(golden.clang heavy build/fuzz-fast/tests/test_golden --gtest_brief=1)
    set_tests_properties(check.golden.clang PROPERTIES FIXTURES_REQUIRED fuzz-fast)
    rubble_add_build(tsan long ${CMAKE_CTEST_COMMAND} --test-dir build/tsan --output-on-failure)
    set_tests_properties(check.build.tsan check.run.tsan PROPERTIES TIMEOUT 7200)
    rubble_add_check(fuzz long tools/fuzz --seconds 3600)
    set_tests_properties(check.fuzz PROPERTIES RUN_SERIAL ON TIMEOUT 43200)
  endif()
  rubble_add_check(mutants long ${python_with_packages} -B tools/mutate)
  set_tests_properties(check.mutants PROPERTIES RUN_SERIAL ON TIMEOUT 14400)
  foreach(platform mingw aarch64)
    rubble_add_check(cross.${platform} long bash tests/packaging/cross ${platform})
    set_tests_properties(check.cross.${platform} PROPERTIES RUN_SERIAL ON TIMEOUT 14400)
  endforeach()
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  rubble_add_build(sanitize long ${CMAKE_CTEST_COMMAND} --test-dir build/sanitize --output-on-failure --parallel ${cores}
    --label-exclude "^long$")

  # A GPU that works: its tests run in the build that has the CUDA backend.
  find_program(RUBBLE_NVIDIA_SMI nvidia-smi)
  if(RUBBLE_NVCC AND RUBBLE_NVIDIA_SMI)
    execute_process(COMMAND ${RUBBLE_NVIDIA_SMI} -L RESULT_VARIABLE no_gpu OUTPUT_QUIET ERROR_QUIET)
    if(no_gpu EQUAL 0)
      rubble_add_build(cuda heavy ${CMAKE_CTEST_COMMAND} --test-dir build/cuda --output-on-failure --label-regex gpu)
      set_tests_properties(check.build.cuda check.run.cuda PROPERTIES LABELS "heavy;gpu")
    endif()
  endif()
endif()

# Other versions of the program lay out some lines in another way.
find_program(clang_format clang-format)
if(clang_format AND RUBBLE_CHECKS)
  execute_process(COMMAND ${clang_format} --version OUTPUT_VARIABLE clang_format_version)
  if(clang_format_version MATCHES "version 14\\.")
    rubble_add_check(layout checks ./dev format --check)
  endif()
endif()
