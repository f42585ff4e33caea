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
set(first_in_others "")
foreach(header IN LISTS headers)
  if(header MATCHES "^pcs/IO/")
    string(APPEND include_IO "#include <${header}>\n")
  else()
    string(APPEND include_all_but_IO "#include <${header}>\n")
  endif()
  file(STRINGS ${PROJECT_SOURCE_DIR}/include/${header} first REGEX "^#include " LIMIT_COUNT 1)
  string(REGEX REPLACE "^#include [<\"]([^>\"]*).*$" "\\1" first_of_${header} "${first}")
  list(APPEND first_in_others ${first_of_${header}})
endforeach()

# Every header compiles alone, and a second time. The first header that another one includes, before anything else, is
# alone at the beginning of that one's source.
set(chains "")
foreach(header IN LISTS headers)
  if(NOT header IN_LIST first_in_others)
    set(text "")
    set(link ${header})
    while(link IN_LIST headers)
      string(APPEND text "#include <${link}>\n")
      set(link "${first_of_${link}}")
    endwhile()
    string(MAKE_C_IDENTIFIER ${header} source)
    pcs_generate(${source}.cpp "${text}${text}")
    list(APPEND chains ${generated}/${source}.cpp)
  endif()
endforeach()
add_library(headers_self_contained OBJECT EXCLUDE_FROM_ALL ${chains})
target_link_libraries(headers_self_contained PRIVATE pcs_syntax_flags pcs_dev_flags)
pcs_add_build_test(headers.self_contained headers_self_contained)

# The headers outside IO/ reach no CGAL package under the GPL. CGAL's GPL headers include
# <CGAL/license/...>, which stops the compiler under CGAL_LICENSE_ERROR, unless the macro of
# a commercial licence is set. The second test proves that the first one can fail.
pcs_generate(no_gpl.cpp "${include_all_but_IO}")
pcs_generate(gpl.cpp "#include <pcs/concepts.h>\n#include <CGAL/Kd_tree.h>\n")
foreach(name no_gpl gpl)
  add_library(license_${name} OBJECT EXCLUDE_FROM_ALL ${generated}/${name}.cpp)
  target_link_libraries(license_${name} PRIVATE pcs_header_flags)
  target_compile_definitions(license_${name} PRIVATE CGAL_LICENSE_ERROR)
endforeach()
pcs_add_build_test(license.no_gpl license_no_gpl)
pcs_add_build_test(license.gpl_is_detected license_gpl)
set_tests_properties(license.gpl_is_detected PROPERTIES
  PASS_REGULAR_EXPRESSION "CGAL_SPATIAL_SEARCHING_COMMERCIAL_LICENSE is not defined")

# Two sources with all headers would link together: no function or variable lacks its `inline`, so the objects hold weak
# symbols only. The last source proves that the check can fail.
pcs_generate(IO.cpp "${include_IO}")
pcs_generate(not_inline.cpp "int not_inline() { return 0; }\n")
foreach(name IO not_inline)
  add_library(headers_${name} OBJECT EXCLUDE_FROM_ALL ${generated}/${name}.cpp)
  target_link_libraries(headers_${name} PRIVATE pcs_header_flags)
endforeach()
if(CMAKE_NM)
  foreach(name license_no_gpl headers_IO headers_not_inline)
    add_custom_target(${name}_symbols
      COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D OBJECT=$<TARGET_OBJECTS:${name}>
              -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/check_symbols.cmake)
    add_dependencies(${name}_symbols ${name})
    pcs_add_build_test(headers.inline.${name} ${name}_symbols)
  endforeach()
  set_tests_properties(headers.inline.headers_not_inline PROPERTIES
    PASS_REGULAR_EXPRESSION "defined once only.*not_inline")
endif()
