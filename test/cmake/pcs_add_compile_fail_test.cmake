# Nothing of this is run: compile without optimisation, or even without code where no object is looked at.
add_library(pcs_header_flags INTERFACE)
target_compile_options(pcs_header_flags INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-O0>)
add_library(pcs_syntax_flags INTERFACE)
target_compile_options(pcs_syntax_flags INTERFACE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-fsyntax-only>)

# A test that builds a target of this build tree, one at a time.
function(pcs_add_build_test test target)
  add_test(NAME ${test} COMMAND ${CMAKE_COMMAND}
           --build ${CMAKE_BINARY_DIR} --target ${target} --config $<CONFIG>)
  set_tests_properties(${test} PROPERTIES RESOURCE_LOCK build_tree LABELS "static;${ARGN}")
endfunction()

# pcs_add_compile_fail_test(<rule> <sentence>)
#
# With PCS_BREAK_THE_RULE defined, compile_fail/<rule>.cpp must make the compiler print <sentence> (a regular expression)
# as its first error. That it compiles as it is, pcs_add_compile_accepted_test() checks. Parsing the headers takes longest,
# so the sources of one algorithm are compiled as one, a namespace each, below all their headers, with the precompiled
# header of the tests; a source that sets macros is compiled alone. The test compile_fail.errors.<algorithm> finds the
# first error of each rule.
set(pcs_rules_dir ${CMAKE_CURRENT_SOURCE_DIR}/compile_fail)
set(pcs_rule_errors_dir ${CMAKE_CURRENT_BINARY_DIR}/compile_fail)
function(pcs_add_compile_fail_test rule sentence)
  set(source ${pcs_rules_dir}/${rule}.cpp)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  file(STRINGS ${source} macros REGEX "^#(define|undef)")
  file(STRINGS ${source} includes REGEX "^#include <")
  set(doors ${includes})
  list(FILTER doors INCLUDE REGEX "<pcs/")
  if(macros OR NOT doors)
    set(group ${rule})
    set_property(GLOBAL PROPERTY pcs_rule_source_of_${group} ${source})
    set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  else()
    list(GET doors 0 door)
    set(group skeleton)
    if(door MATCHES "deform")
      set(group deformation)
    elseif(door MATCHES "[Oo]rl")
      set(group shape_space)
    endif()
    set_property(GLOBAL PROPERTY pcs_rule_source_of_${group}
      ${CMAKE_CURRENT_BINARY_DIR}/compile_fail_${group}.cpp)
    set_property(GLOBAL APPEND PROPERTY pcs_rule_headers_of_${group} ${includes})
    set_property(GLOBAL APPEND_STRING PROPERTY pcs_rule_text_of_${group}
      "namespace ${rule} {\n#include \"${source}\"\n}\n")
  endif()
  set_property(GLOBAL APPEND PROPERTY pcs_rule_groups ${group})

  add_test(NAME compile_fail.${rule} COMMAND ${CMAKE_COMMAND}
    -D RULE=${rule} -D ERRORS=${pcs_rule_errors_dir}/${group}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/check_rejected.cmake)
  set_tests_properties(compile_fail.${rule} PROPERTIES
    PASS_REGULAR_EXPRESSION "${sentence}" LABELS "static;compile_fail"
    FIXTURES_REQUIRED compile_fail_errors_${group})
endfunction()

# One test for each algorithm that compiles the broken sources of its rules, and one test that builds all sources of
# the rules as they are.
function(pcs_add_compile_accepted_test)
  get_property(groups GLOBAL PROPERTY pcs_rule_groups)
  list(REMOVE_DUPLICATES groups)
  set(sources "")
  foreach(group IN LISTS groups)
    get_property(source GLOBAL PROPERTY pcs_rule_source_of_${group})
    get_property(headers GLOBAL PROPERTY pcs_rule_headers_of_${group})
    get_property(text GLOBAL PROPERTY pcs_rule_text_of_${group})
    list(APPEND sources ${source})
    if(text)
      list(REMOVE_DUPLICATES headers)
      list(JOIN headers "\n" headers)
      file(GENERATE OUTPUT ${source} CONTENT "${headers}\n${text}")
    endif()
    set(errors ${pcs_rule_errors_dir}/${group})
    add_test(NAME compile_fail.errors.${group} COMMAND ${CMAKE_COMMAND}
      -D COMMANDS=${CMAKE_BINARY_DIR}/compile_commands.json -D TARGET=compile_fail_rejected
      -D SOURCE=${source} -D RULES=${pcs_rules_dir} -D ERRORS=${errors}
      -D COMPILER=${CMAKE_CXX_COMPILER_ID}
      -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/check_rejected.cmake)
    set_tests_properties(compile_fail.errors.${group} PROPERTIES
      LABELS "static;compile_fail" FIXTURES_SETUP compile_fail_errors_${group})
  endforeach()

  foreach(library compile_fail_accepted compile_fail_rejected)
    add_library(${library} OBJECT EXCLUDE_FROM_ALL ${sources})
    target_link_libraries(${library} PRIVATE pcs_test_flags pcs_syntax_flags)
    target_compile_options(${library} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-w>)
    target_precompile_headers(${library} REUSE_FROM pcs_test_pch)
    set_target_properties(${library} PROPERTIES EXPORT_COMPILE_COMMANDS ON UNITY_BUILD OFF)
  endforeach()
  target_compile_definitions(compile_fail_rejected PRIVATE PCS_BREAK_THE_RULE)
  pcs_add_build_test(compile_fail.all_accepted compile_fail_accepted compile_fail long)
endfunction()
