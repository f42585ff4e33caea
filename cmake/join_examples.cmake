# pcs_join_examples(<target> <name>...)
#
# Adds an executable that runs the example `name` if this is its argument. All examples are compiled
# as one source, each in a namespace, so that their headers are read and instantiated once.
function(pcs_join_examples target)
  set(includes "#include <cstring>")
  set(namespaces "")
  set(calls "")
  foreach(name IN LISTS ARGN)
    set(source ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    file(STRINGS ${source} lines REGEX "^#include ")
    list(APPEND includes ${lines})
    string(APPEND namespaces "namespace example_${name} {\n#include \"${source}\"\n}\n")
    string(APPEND calls
      "  if (std::strcmp(argv[1], \"${name}\") == 0)\n    return example_${name}::main();\n")
  endforeach()
  list(REMOVE_DUPLICATES includes)
  list(JOIN includes "\n" includes)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp CONTENT
"${includes}
${namespaces}
int main(int argc, char* argv[])
{
  if (argc != 2)
    return 2;
${calls}  return 2;
}
" @ONLY)
  add_executable(${target} ${CMAKE_CURRENT_BINARY_DIR}/${target}.cpp)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${target} PRIVATE ${PCS_LIBRARY} pcs_dev_flags)
endfunction()
