# cmake -D PCS_ROOT=<dir> -P check_listed_tests.cmake
#
# Every source test_*.cpp below test/ must be named in a CMakeLists.txt below test/.

cmake_minimum_required(VERSION 3.21)

file(GLOB_RECURSE lists ${PCS_ROOT}/test/CMakeLists.txt)
set(all "")
foreach(list IN LISTS lists)
  file(READ ${list} text)
  string(APPEND all "${text}")
endforeach()
file(GLOB_RECURSE sources ${PCS_ROOT}/test/test_*.cpp)
list(LENGTH sources count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} sources of tests were found")
endif()
foreach(source IN LISTS sources)
  get_filename_component(name ${source} NAME)
  string(FIND "${all}" "${name}" place)
  if(place EQUAL -1)
    message(SEND_ERROR "${source} is not named in a CMakeLists.txt")
  endif()
endforeach()
message(STATUS "${count} sources of tests")
