# A test that builds a target of this build tree, one at a time.
function(pcs_add_build_test test target)
  add_test(NAME ${test} COMMAND ${CMAKE_COMMAND}
           --build ${CMAKE_BINARY_DIR} --target ${target} --config $<CONFIG>)
  set_tests_properties(${test} PROPERTIES RESOURCE_LOCK build_tree LABELS "static;${ARGN}")
endfunction()

# pcs_add_compile_fail_test(<rule> <sentence>)
#
# Builds compile_fail/<rule>.cpp twice: it must compile as it is, and with PCS_BREAK_THE_RULE defined
# the compiler must print <sentence> (a regular expression).
function(pcs_add_compile_fail_test rule sentence)
  foreach(kind accepted rejected)
    add_library(${rule}_${kind} OBJECT EXCLUDE_FROM_ALL compile_fail/${rule}.cpp)
    target_link_libraries(${rule}_${kind} PRIVATE pcs::pcs)
    pcs_add_build_test(compile_fail.${rule}.${kind} ${rule}_${kind} compile_fail)
  endforeach()
  target_compile_definitions(${rule}_rejected PRIVATE PCS_BREAK_THE_RULE)
  set_tests_properties(compile_fail.${rule}.rejected PROPERTIES
    PASS_REGULAR_EXPRESSION "${sentence}")
endfunction()
