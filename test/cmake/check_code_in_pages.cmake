# cmake -D PCS_ROOT=<dir> [-D DO_UPDATE=ON] -P check_code_in_pages.cmake
#
# The code block after a line <!-- example FILE TAG --> of README.md or of the user manual must be
# the text between the two lines `//! [TAG]` of examples/FILE, without the indentation of its first
# line. DO_UPDATE replaces code blocks that differ.

cmake_minimum_required(VERSION 3.21)

# Sets <before_var>, <text_var> and <after_var> to the text before <begin>, between <begin> and
# <end>, and from <end> on.
function(split all begin end before_var text_var after_var)
  string(FIND "${all}" "${begin}" from)
  if(from EQUAL -1)
    message(FATAL_ERROR "'${begin}' is missing")
  endif()
  string(LENGTH "${begin}" length)
  math(EXPR from "${from} + ${length}")
  string(SUBSTRING "${all}" 0 ${from} before)
  string(SUBSTRING "${all}" ${from} -1 rest)
  string(FIND "${rest}" "${end}" length)
  if(length EQUAL -1)
    message(FATAL_ERROR "'${end}' is missing after '${begin}'")
  endif()
  string(SUBSTRING "${rest}" 0 ${length} text)
  string(SUBSTRING "${rest}" ${length} -1 after)
  set(${before_var} "${before}" PARENT_SCOPE)
  set(${text_var} "${text}" PARENT_SCOPE)
  set(${after_var} "${after}" PARENT_SCOPE)
endfunction()

# Sets <text_var> to a tagged part of an example.
function(read_example file tag text_var)
  file(READ ${PCS_ROOT}/examples/${file} source)
  split("${source}" "//! [${tag}]\n" "//! [${tag}]" before text after)
  string(REGEX REPLACE " +$" "" text "${text}") # the indentation of the last line
  if(text MATCHES "^( +)")
    string(REPLACE "\n${CMAKE_MATCH_1}" "\n" text "\n${text}")
    string(SUBSTRING "${text}" 1 -1 text)
  endif()
  set(${text_var} "${text}" PARENT_SCOPE)
endfunction()

set(count 0)
file(GLOB pages ${PCS_ROOT}/README.md ${PCS_ROOT}/doc/user_manual/*.md)
foreach(page IN LISTS pages)
  file(READ ${page} text)
  if(text MATCHES "(^|\n)[\\]snippet ")
    message(FATAL_ERROR "${page} has a \\snippet, which only Doxygen shows; write a line "
                        "<!-- example FILE TAG --> and a code block instead")
  endif()
  set(is_changed OFF)
  string(REGEX MATCHALL "<!-- example [^ ]+ [^ ]+ -->" marks "${text}")
  foreach(mark IN LISTS marks)
    string(REGEX MATCH "<!-- example ([^ ]+) ([^ ]+) -->" mark "${mark}")
    set(file ${CMAKE_MATCH_1})
    set(tag ${CMAKE_MATCH_2})
    read_example(${file} ${tag} expected)
    split("${text}" "${mark}\n```cpp\n" "```\n" before shown after)
    math(EXPR count "${count} + 1")
    if(shown STREQUAL expected)
      continue()
    elseif(DO_UPDATE)
      set(text "${before}${expected}${after}")
      set(is_changed ON)
    else()
      message(FATAL_ERROR "${page} does not show the part ${tag} of examples/${file} as it is; "
                          "cmake -D PCS_ROOT=. -D DO_UPDATE=ON -P "
                          "test/cmake/check_code_in_pages.cmake updates it")
    endif()
  endforeach()
  if(is_changed)
    file(WRITE ${page} "${text}")
  endif()
endforeach()
if(count LESS 20)
  message(FATAL_ERROR "only ${count} code blocks were found")
endif()
message(STATUS "${count} code blocks")
