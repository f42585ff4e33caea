# cmake -D PCS_ROOT=<dir> -P check_named_tests.cmake
#
# Every name in the tables of doc/user_manual/faults.md, `a_name_with_several_words`, must be a test
# case below test/.

cmake_minimum_required(VERSION 3.21)

file(GLOB_RECURSE sources ${PCS_ROOT}/test/*.cpp)
set(all "")
foreach(source IN LISTS sources)
  file(STRINGS ${source} lines REGEX "_TEST_CASE\\(|TEST_CASE_TEMPLATE\\(")
  string(APPEND all "${lines}")
endforeach()
file(READ ${PCS_ROOT}/doc/user_manual/faults.md page)
string(REGEX MATCHALL "`[a-z]+_[a-z_]+_[a-z_]+`" names "${page}")
set(count 0)
foreach(name IN LISTS names)
  string(REPLACE "`" "" name "${name}")
  if(NOT all MATCHES "\\(${name}[,)]")
    message(SEND_ERROR "faults.md names the test ${name}, which does not exist")
  endif()
  math(EXPR count "${count} + 1")
endforeach()
if(count LESS 50)
  message(FATAL_ERROR "only ${count} names of tests were found in faults.md")
endif()
message(STATUS "${count} names of tests")
