# cmake -D PCS_ROOT=<dir> -P check_readme.cmake
#
# The first code block after <!-- readme_example --> in README.md must be the text between the two
# lines `//! [readme_example]` of examples/readme_example.cpp.

cmake_minimum_required(VERSION 3.21)
file(READ ${PCS_ROOT}/README.md readme)
file(READ ${PCS_ROOT}/examples/readme_example.cpp example)

# Sets <text_var> to the text between <begin> and <end>.
function(text_between all begin end text_var)
  string(FIND "${all}" "${begin}" from)
  if(from EQUAL -1)
    message(FATAL_ERROR "'${begin}' is missing")
  endif()
  string(LENGTH "${begin}" length)
  math(EXPR from "${from} + ${length}")
  string(SUBSTRING "${all}" ${from} -1 rest)
  string(FIND "${rest}" "${end}" length)
  if(length EQUAL -1)
    message(FATAL_ERROR "'${end}' is missing after '${begin}'")
  endif()
  string(SUBSTRING "${rest}" 0 ${length} text)
  set(${text_var} "${text}" PARENT_SCOPE)
endfunction()

text_between("${readme}" "<!-- readme_example -->\n```cpp\n" "```" in_readme)
text_between("${example}" "//! [readme_example]\n" "//! [readme_example]" in_example)
if(NOT in_readme STREQUAL in_example)
  message(FATAL_ERROR "README.md does not show examples/readme_example.cpp as it is; "
                      "the example reads:\n${in_example}")
endif()
