# cmake -D PCS_ROOT=<dir> -P check_versions.cmake
#
# The recipes of package managers must have the version of the project.

cmake_minimum_required(VERSION 3.21)
file(READ ${PCS_ROOT}/CMakeLists.txt project)
string(REGEX MATCH "VERSION ([0-9]+\\.[0-9]+\\.[0-9]+)\n" found "${project}")
set(version "${CMAKE_MATCH_1}")
if(NOT version)
  message(FATAL_ERROR "CMakeLists.txt has no version")
endif()

file(READ ${PCS_ROOT}/cmake/vcpkg/pcs/vcpkg.json port)
string(JSON port_version GET "${port}" version)
file(READ ${PCS_ROOT}/conanfile.py recipe)
string(REGEX MATCH "version = \"([^\"]*)\"" found "${recipe}")
set(recipe_version "${CMAKE_MATCH_1}")
foreach(recipe IN ITEMS port recipe)
  if(NOT ${recipe}_version STREQUAL version)
    message(FATAL_ERROR "the version of the ${recipe} is ${${recipe}_version}, "
                        "the version of the project is ${version}")
  endif()
endforeach()
message(STATUS "all recipes have the version ${version}")
