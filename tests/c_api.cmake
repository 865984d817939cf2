# The C library as C sees it, and the Python package on top of it. Python tests are skipped where numpy is missing.

if(NOT TARGET rubble_c)
  return()
endif()
enable_language(C)

function(rubble_add_c_program name source)
  add_executable(${name} ${source})
  set_target_properties(${name} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
  target_compile_options(${name} PRIVATE -Wall -Wextra -pedantic -Werror)
  target_link_libraries(${name} PRIVATE rubble_c m)
endfunction()

rubble_add_c_program(c_api_test ${CMAKE_CURRENT_SOURCE_DIR}/c_api/c_api_test.c)
rubble_add_c_program(c_hello ${PROJECT_SOURCE_DIR}/examples/hello.c)
add_test(NAME c_api.calls COMMAND c_api_test)
add_test(NAME c_api.hello COMMAND c_hello)
set_tests_properties(c_api.hello PROPERTIES PASS_REGULAR_EXPRESSION "the crate rests at 0\\.[45][0-9] m")
add_test(NAME c_api.exports COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/c_api/exports_test.py
  $<TARGET_FILE:rubble_c> ${PROJECT_SOURCE_DIR}/include/rubble/c)
add_test(NAME c_api.python_declarations COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/tools/make_python_abi --check)
set_tests_properties(c_api.calls c_api.hello c_api.exports c_api.python_declarations PROPERTIES LABELS c_api TIMEOUT 900)

# The interpreter of the system has the numpy that ./dev installs; another one may come first in the path.
set(python_with_numpy ${Python3_EXECUTABLE})
execute_process(COMMAND ${Python3_EXECUTABLE} -c "import numpy" RESULT_VARIABLE lacks_numpy OUTPUT_QUIET ERROR_QUIET)
if(lacks_numpy)
  find_program(RUBBLE_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  if(RUBBLE_SYSTEM_PYTHON)
    set(python_with_numpy ${RUBBLE_SYSTEM_PYTHON})
  endif()
endif()
file(GLOB scripts RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/python/*_test.py)
foreach(script IN LISTS scripts)
  string(REGEX REPLACE "^python/(.*)_test.py$" "python.\\1" name ${script})
  add_test(NAME ${name} COMMAND ${python_with_numpy} -B ${CMAKE_CURRENT_SOURCE_DIR}/${script})
  set_tests_properties(${name} PROPERTIES LABELS python TIMEOUT 900 SKIP_RETURN_CODE 77
    ENVIRONMENT "RUBBLE_LIBRARY=$<TARGET_FILE:rubble_c>;PYTHONPATH=${PROJECT_SOURCE_DIR}/python")
endforeach()
