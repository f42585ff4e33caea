# Tests that read files and compile nothing.

function(pcs_add_script_test test script)
  add_test(NAME ${test} COMMAND ${CMAKE_COMMAND} -D PCS_ROOT=${PROJECT_SOURCE_DIR} ${ARGN}
           -P ${PROJECT_SOURCE_DIR}/test/cmake/${script})
  set_tests_properties(${test} PROPERTIES LABELS static SKIP_REGULAR_EXPRESSION "SKIPPED:")
endfunction()

# Who may include whom; the second test proves that the first one can fail.
pcs_add_script_test(layers.include_rules check_include_rules.cmake
  -D INCLUDE_DIR=${PROJECT_SOURCE_DIR}/include)
pcs_add_script_test(layers.violations_are_detected check_include_rules.cmake
  -D INCLUDE_DIR=${PROJECT_SOURCE_DIR}/test/cmake/bad_includes)
set_tests_properties(layers.violations_are_detected PROPERTIES
  PASS_REGULAR_EXPRESSION "15 broken include rules")

find_program(PCS_CLANG_FORMAT NAMES clang-format-14 clang-format)
pcs_add_script_test(format.clang_format check_format.cmake
  -D CLANG_FORMAT=${PCS_CLANG_FORMAT})

pcs_add_script_test(format.line_length check_line_length.cmake)

pcs_add_script_test(manual.code check_code_in_pages.cmake)
pcs_add_script_test(manual.named_tests check_named_tests.cmake)
pcs_add_script_test(tests.are_listed check_listed_tests.cmake)
pcs_add_script_test(install.versions check_versions.cmake)
