# cmake -D PCS_ROOT=<dir> -P check_line_length.cmake
#
# No line of a source is longer than 100 columns, comments included, which clang-format does not wrap. Lines without a
# blank (an address, a path) may be longer.

cmake_minimum_required(VERSION 3.21)
set(most_columns 100)
string(REPEAT "." ${most_columns} full)

set(files)
foreach(folder include test examples benchmark cmake)
  file(GLOB_RECURSE found ${PCS_ROOT}/${folder}/*.h ${PCS_ROOT}/${folder}/*.cpp)
  list(APPEND files ${found})
endforeach()
list(FILTER files EXCLUDE REGEX "/test/cmake/bad_includes/")
set(number_of_long_lines 0)
foreach(file IN LISTS files)
  file(STRINGS ${file} long REGEX "^${full}.")
  foreach(line IN LISTS long)
    string(STRIP "${line}" line)
    if(line MATCHES " ")
      message("${file}: ${line}")
      math(EXPR number_of_long_lines "${number_of_long_lines} + 1")
    endif()
  endforeach()
endforeach()
list(LENGTH files number_of_files)
if(number_of_files EQUAL 0)
  message(FATAL_ERROR "no sources below ${PCS_ROOT}")
endif()
if(number_of_long_lines GREATER 0)
  message(FATAL_ERROR "${number_of_long_lines} lines of more than ${most_columns} columns")
endif()
message("${number_of_files} sources keep to ${most_columns} columns")
