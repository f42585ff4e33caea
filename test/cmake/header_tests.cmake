# Tests of all headers at once, from generated sources. A new header is found without being listed.

file(GLOB_RECURSE headers CONFIGURE_DEPENDS
  RELATIVE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/include/pcs/*.h)
list(SORT headers)
set(generated ${CMAKE_CURRENT_BINARY_DIR}/headers)

# Rewrites a file only when its text differs, so that nothing is compiled again without need.
function(pcs_generate file text)
  file(GENERATE OUTPUT ${generated}/${file} CONTENT "${text}")
endfunction()

set(include_all_but_IO "")
set(include_IO "")
foreach(header IN LISTS headers)
  if(header MATCHES "^pcs/IO/")
    string(APPEND include_IO "#include <${header}>\n")
  else()
    string(APPEND include_all_but_IO "#include <${header}>\n")
  endif()
  file(STRINGS ${PROJECT_SOURCE_DIR}/include/${header} includes_of_${header} REGEX "^#include ")
  list(TRANSFORM includes_of_${header} REPLACE "^#include [<\"]([^>\"]*).*$" "\\1")
  list(FILTER includes_of_${header} INCLUDE REGEX "^pcs/")
  list(FILTER includes_of_${header} EXCLUDE REGEX "_impl\\.h$") # which includes its header
endforeach()

# reached_from_<header>: all that it includes, directly or not.
function(pcs_find_reached header)
  if(DEFINED reached_from_${header})
    return()
  endif()
  set(reached ${includes_of_${header}})
  foreach(included IN LISTS includes_of_${header})
    pcs_find_reached(${included})
    list(APPEND reached ${reached_from_${included}})
  endforeach()
  list(REMOVE_DUPLICATES reached)
  set(reached_from_${header} ${reached} CACHE INTERNAL "")
endfunction()
set(by_reach "")
foreach(header IN LISTS headers)
  unset(reached_from_${header} CACHE)
endforeach()
foreach(header IN LISTS headers)
  pcs_find_reached(${header})
  list(LENGTH reached_from_${header} count)
  math(EXPR count "10000 + ${count}")
  list(APPEND by_reach ${count}:${header})
endforeach()
list(SORT by_reach ORDER DESCENDING)
list(TRANSFORM by_reach REPLACE "^[0-9]*:" "")

# Every header compiles alone, and a second time. What precedes a header in a source is included by it in any case, so
# that a source tests a chain of headers, each of which includes the one before. That takes minutes: `./run headers`
# compiles all of them, and the test, of what users include, has the label `long`.
set(rest ${by_reach})
function(pcs_add_header_chains name regex)
  set(chains "")
  foreach(header IN LISTS by_reach)
    if(NOT header IN_LIST rest OR NOT header MATCHES "${regex}")
      continue()
    endif()
    string(MAKE_C_IDENTIFIER ${header} source)
    set(text "")
    while(header)
      string(PREPEND text "#include <${header}>\n")
      list(REMOVE_ITEM rest ${header})
      set(next "")
      foreach(candidate IN LISTS rest) # those that reach most come first
        if(candidate IN_LIST includes_of_${header})
          set(next ${candidate})
          break()
        endif()
      endforeach()
      set(header ${next})
    endwhile()
    pcs_generate(${source}.cpp "${text}${text}")
    list(APPEND chains ${generated}/${source}.cpp)
  endforeach()
  set(rest ${rest} PARENT_SCOPE)
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${chains})
  target_link_libraries(${name} PRIVATE pcs::pcs pcs_syntax_flags pcs_dev_flags)
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
endfunction()
pcs_add_header_chains(headers_of_users "^pcs/((IO|core|generators|splats|crowns)/)?[^/]*$")
pcs_add_header_chains(headers_of_stages ".")
pcs_add_build_test(headers.self_contained headers_of_users long)

# -ffast-math would remove the checks for NaN and infinity. core/errors.h refuses it, and every public function includes
# that header; the other headers that users include check no values. Without exceptions, `throw` does not compile.
set(without_checks pcs/concepts.h pcs/Named_function_parameters.h pcs/generators/Hidden_wood.h
  pcs/generators/Virtual_scan.h)
foreach(header IN LISTS headers)
  if(header MATCHES "^pcs/((IO|generators)/)?[^/]*$" AND NOT header IN_LIST without_checks
      AND NOT "pcs/core/errors.h" IN_LIST reached_from_${header})
    message(SEND_ERROR "${header} does not include pcs/core/errors.h, which refuses -ffast-math")
  endif()
endforeach()
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  pcs_generate(flags.cpp "#include <pcs/core/parameters/check_value.h>\n")
  foreach(flag fast-math no-exceptions)
    string(MAKE_C_IDENTIFIER ${flag} name)
    add_library(headers_${name} OBJECT EXCLUDE_FROM_ALL ${generated}/flags.cpp)
    target_link_libraries(headers_${name} PRIVATE pcs::pcs pcs_syntax_flags)
    target_compile_options(headers_${name} PRIVATE -f${flag} -Wfatal-errors)
    pcs_add_build_test(headers.${name}_is_refused headers_${name})
  endforeach()
  set_tests_properties(headers.fast_math_is_refused PROPERTIES
    PASS_REGULAR_EXPRESSION "which -ffast-math removes: add -fno-finite-math-only")
  set_tests_properties(headers.no_exceptions_is_refused PROPERTIES
    PASS_REGULAR_EXPRESSION "exception handling disabled|exceptions disabled")
endif()

# The headers outside IO/ reach no CGAL package under the GPL. CGAL's GPL headers include
# <CGAL/license/...>, which stops the compiler under CGAL_LICENSE_ERROR, unless the macro of
# a commercial licence is set. The second test proves that the first one can fail.
pcs_generate(no_gpl.cpp "${include_all_but_IO}")
pcs_generate(gpl.cpp "#include <pcs/concepts.h>\n#include <CGAL/Kd_tree.h>\n")
foreach(name no_gpl gpl)
  add_library(license_${name} OBJECT EXCLUDE_FROM_ALL ${generated}/${name}.cpp)
  target_link_libraries(license_${name} PRIVATE pcs::pcs pcs_header_flags)
  target_compile_definitions(license_${name} PRIVATE CGAL_LICENSE_ERROR)
  # the preprocessor meets the #error
  target_compile_options(license_${name} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-E>)
endforeach()
pcs_add_build_test(license.no_gpl license_no_gpl)
pcs_add_build_test(license.gpl_is_detected license_gpl)
set_tests_properties(license.gpl_is_detected PROPERTIES
  PASS_REGULAR_EXPRESSION "CGAL_SPATIAL_SEARCHING_COMMERCIAL_LICENSE is not defined")

# Two sources with all headers would link together: no function or variable lacks its `inline`, so the objects hold weak
# symbols only. The last source proves that the check can fail. The headers outside IO/ take minutes, hence `long`.
pcs_generate(IO.cpp "${include_IO}")
pcs_generate(not_inline.cpp "int not_inline() { return 0; }\n")
pcs_generate(all_but_IO.cpp "${include_all_but_IO}")
foreach(name IO all_but_IO not_inline)
  add_library(headers_${name} OBJECT EXCLUDE_FROM_ALL ${generated}/${name}.cpp)
  target_link_libraries(headers_${name} PRIVATE pcs::pcs pcs_header_flags)
endforeach()
if(CMAKE_NM)
  foreach(name headers_all_but_IO headers_IO headers_not_inline)
    add_custom_target(${name}_symbols
      COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D OBJECT=$<TARGET_OBJECTS:${name}>
              -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/check_symbols.cmake)
    add_dependencies(${name}_symbols ${name})
    pcs_add_build_test(headers.inline.${name} ${name}_symbols)
  endforeach()
  set_property(TEST headers.inline.headers_all_but_IO APPEND PROPERTY LABELS long)
  set_tests_properties(headers.inline.headers_not_inline PROPERTIES
    PASS_REGULAR_EXPRESSION "defined once only.*not_inline")
endif()
