# What all test executables share: main(), the flags, and the headers that take long to parse.
# Sources need no BOOST_TEST_MODULE; a source that has one still links, the library is an archive.
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/test_main.cpp
  "#define BOOST_TEST_MODULE pcs\n#include <boost/test/unit_test.hpp>\n")
add_library(pcs_test_main STATIC ${CMAKE_CURRENT_BINARY_DIR}/test_main.cpp)
target_link_libraries(pcs_test_main PUBLIC Boost::unit_test_framework)
target_compile_definitions(pcs_test_main PUBLIC BOOST_TEST_DYN_LINK)
target_compile_features(pcs_test_main PUBLIC cxx_std_17)

add_library(pcs_test_flags INTERFACE)
target_link_libraries(pcs_test_flags INTERFACE ${PCS_LIBRARY} pcs_dev_flags pcs_test_main)
target_include_directories(pcs_test_flags INTERFACE ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(pcs_test_flags INTERFACE
  CGAL_DEBUG # preconditions throw in release builds, too
  PCS_TEST_DATA_DIR="${PROJECT_SOURCE_DIR}/test/data")
target_compile_options(pcs_test_flags INTERFACE
  # -fpch-preprocess lets ccache work with the precompiled header; sources that are compiled as one are headers to GCC,
  # whose unnamed namespaces it warns about
  $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess;-Wno-subobject-linkage>)

file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/test_pch.cpp "")
add_library(pcs_test_pch OBJECT ${CMAKE_CURRENT_BINARY_DIR}/test_pch.cpp)
target_link_libraries(pcs_test_pch PRIVATE pcs_test_flags)
target_precompile_headers(pcs_test_pch PRIVATE
  <CGAL/Aff_transformation_3.h>
  <CGAL/Exact_predicates_inexact_constructions_kernel.h>
  <CGAL/Named_function_parameters.h>
  <CGAL/Simple_cartesian.h>
  <boost/container/small_vector.hpp> <boost/graph/adjacency_list.hpp> <boost/test/unit_test.hpp>
  <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/SparseCholesky>
  <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map> <optional> <random> <sstream> <string>
  <unordered_map> <vector>)

# pcs_add_test_executable(<name> SOURCES <file>... SUITES <suite>...
#                         [FOLDER <folder>] [LABELS <label>...] [LIBRARIES <target>...])
#
# One executable, and one ctest `<folder>.<suite>` for each Boost.Test suite in it. The label is
# `unit` if none is given. A suite that does not exist is a failure (exit code 200 of Boost.Test), and
# one that is not listed is an error.
# The preset `test` compiles several sources as one, in half the time: of an executable with several
# sources, each has a namespace of its own, which is named like the file.
function(pcs_add_test_executable name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FOLDER" "SOURCES;SUITES;LABELS;LIBRARIES")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES OR NOT arg_SUITES)
    message(FATAL_ERROR "pcs_add_test_executable(${name}): SOURCES and SUITES are needed; "
                        "not understood: '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  set(prefix "")
  if(arg_FOLDER)
    set(prefix "${arg_FOLDER}.")
  endif()

  foreach(source IN LISTS arg_SOURCES)
    file(STRINGS ${source} lines REGEX "^BOOST_(AUTO|FIXTURE)_TEST_SUITE\\(")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[A-Z_]+\\(([A-Za-z0-9_]+).*" "\\1" suite "${line}")
      if(NOT suite IN_LIST arg_SUITES)
        message(SEND_ERROR "pcs_add_test_executable(${name}): the suite ${suite} of ${source} is not "
                           "in SUITES")
      endif()
    endforeach()
  endforeach()

  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE pcs_test_flags ${arg_LIBRARIES})
  if(NOT arg_LIBRARIES) # other flags would need another precompiled header
    target_precompile_headers(${name} REUSE_FROM pcs_test_pch)
  endif()
  foreach(suite IN LISTS arg_SUITES)
    add_test(NAME ${prefix}${suite} COMMAND ${name} --run_test=${suite})
    set_tests_properties(${prefix}${suite} PROPERTIES LABELS "${arg_LABELS}")
  endforeach()
endfunction()
