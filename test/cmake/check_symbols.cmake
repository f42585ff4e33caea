# cmake -D NM=<nm> -D OBJECT=<file> -P check_symbols.cmake
#
# Fails if an object file that only includes headers defines a symbol that no second one may define.

cmake_minimum_required(VERSION 3.21)

execute_process(COMMAND ${NM} ${OBJECT} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]* [TDBRSC] [^\n]*" strong "${symbols}")
if(strong)
  list(JOIN strong "\n" strong)
  message(FATAL_ERROR "defined once only, `inline` is missing:\n${strong}")
endif()
