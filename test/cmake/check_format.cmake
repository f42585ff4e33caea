# cmake -D PCS_ROOT=<dir> -D CLANG_FORMAT=<program> -P check_format.cmake

cmake_minimum_required(VERSION 3.21)
if(NOT CLANG_FORMAT)
  message("SKIPPED: clang-format is not installed")
  return()
endif()
execute_process(COMMAND ${CLANG_FORMAT} --version OUTPUT_VARIABLE version)
if(NOT version MATCHES "version 14\\.")
  message("SKIPPED: releases of clang-format differ in their opinions; 14 is needed, found ${version}")
  return()
endif()

set(files)
foreach(folder include test examples benchmark cmake)
  file(GLOB_RECURSE found ${PCS_ROOT}/${folder}/*.h ${PCS_ROOT}/${folder}/*.cpp)
  list(APPEND files ${found})
endforeach()
list(FILTER files EXCLUDE REGEX "/test/cmake/bad_includes/")

execute_process(COMMAND ${CLANG_FORMAT} --style=file --dry-run -Werror ${files}
  RESULT_VARIABLE result)
if(result)
  message(FATAL_ERROR "mend it with: ./run format")
endif()
