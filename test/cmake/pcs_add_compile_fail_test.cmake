# Nothing of this is run: compile without optimisation, or even without code where no object is looked at.
add_library(pcs_header_flags INTERFACE)
target_compile_options(pcs_header_flags INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-O0>)
add_library(pcs_syntax_flags INTERFACE)
target_link_libraries(pcs_syntax_flags INTERFACE pcs_header_flags)
target_compile_options(pcs_syntax_flags INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-fsyntax-only>)

# A test that builds a target of this build tree, one at a time.
function(pcs_add_build_test test target)
  add_test(NAME ${test} COMMAND ${CMAKE_COMMAND}
           --build ${CMAKE_BINARY_DIR} --target ${target} --config $<CONFIG>)
  set_tests_properties(${test} PROPERTIES RESOURCE_LOCK build_tree LABELS "static;${ARGN}")
endfunction()

# pcs_add_compile_fail_test(<rule> <sentence>)
#
# With PCS_BREAK_THE_RULE defined, compile_fail/<rule>.cpp must make the compiler print <sentence> (a
# regular expression) as its first error. That it compiles as it is, pcs_add_compile_accepted_test() sees to.
function(pcs_add_compile_fail_test rule sentence)
  set_property(GLOBAL APPEND PROPERTY pcs_compile_fail_sources
    ${CMAKE_CURRENT_SOURCE_DIR}/compile_fail/${rule}.cpp)
  add_library(${rule}_rejected OBJECT EXCLUDE_FROM_ALL compile_fail/${rule}.cpp)
  set_target_properties(${rule}_rejected PROPERTIES EXPORT_COMPILE_COMMANDS ON UNITY_BUILD OFF)
  target_link_libraries(${rule}_rejected PRIVATE ${PCS_LIBRARY} pcs_syntax_flags)
  target_compile_options(${rule}_rejected PRIVATE
    $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-Wfatal-errors>)
  target_compile_definitions(${rule}_rejected PRIVATE PCS_BREAK_THE_RULE)
  add_test(NAME compile_fail.${rule} COMMAND ${CMAKE_COMMAND}
    -D COMMANDS=${CMAKE_BINARY_DIR}/compile_commands.json -D TARGET=${rule}_rejected
    -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/check_rejected.cmake)
  set_tests_properties(compile_fail.${rule} PROPERTIES
    PASS_REGULAR_EXPRESSION "${sentence}" LABELS "static;compile_fail")
endfunction()

# One test that builds all sources of the rules as they are: those with the same first header of pcs side by side in
# one source, a namespace each, below all their headers. A source that sets macros stands alone.
function(pcs_add_compile_accepted_test)
  get_property(sources GLOBAL PROPERTY pcs_compile_fail_sources)
  set(alone "")
  set(doors "")
  foreach(source IN LISTS sources)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    get_filename_component(rule ${source} NAME_WE)
    file(STRINGS ${source} macros REGEX "^#(define|undef)")
    file(STRINGS ${source} includes REGEX "^#include <")
    list(FILTER includes INCLUDE REGEX "<pcs/")
    if(macros OR NOT includes)
      list(APPEND alone ${source})
      continue()
    endif()
    list(GET includes 0 door)
    string(MAKE_C_IDENTIFIER "${door}" door)
    list(APPEND doors ${door})
    file(STRINGS ${source} includes REGEX "^#include <")
    list(APPEND headers_of_${door} ${includes})
    string(APPEND text_of_${door} "namespace ${rule} {\n#include \"${source}\"\n}\n")
  endforeach()
  list(REMOVE_DUPLICATES doors)
  set(generated "")
  foreach(door IN LISTS doors)
    list(REMOVE_DUPLICATES headers_of_${door})
    list(JOIN headers_of_${door} "\n" headers)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/compile_accepted/${door}.cpp)
    file(GENERATE OUTPUT ${file} CONTENT "${headers}\n${text_of_${door}}")
    list(APPEND generated ${file})
  endforeach()
  add_library(compile_fail_accepted OBJECT EXCLUDE_FROM_ALL ${alone} ${generated})
  target_link_libraries(compile_fail_accepted PRIVATE ${PCS_LIBRARY} pcs_syntax_flags)
  set_target_properties(compile_fail_accepted PROPERTIES UNITY_BUILD OFF)
  pcs_add_build_test(compile_fail.all_accepted compile_fail_accepted compile_fail)
endfunction()
