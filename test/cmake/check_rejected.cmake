# cmake -D COMMANDS=<compile_commands.json> -D TARGET=<target> -P check_rejected.cmake
#
# Runs the compiler on the one source of <target>, which must not compile, and prints what it says.
# Unlike a build of the target, several of these can run side by side.
file(STRINGS ${COMMANDS} line REGEX "\"command\":.*/${TARGET}\\.dir/")
string(REGEX REPLACE "^.*\"command\": *" "" command "${line}")
string(REGEX REPLACE ",[ \t]*$" "" command "${command}")
string(JSON command ERROR_VARIABLE error GET "[${command}]" 0)
if(error OR NOT command)
  message(FATAL_ERROR "${COMMANDS} has no one command for ${TARGET}: ${error}")
endif()
separate_arguments(command UNIX_COMMAND "${command}")
execute_process(COMMAND ${command} -fsyntax-only
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  set(output "${TARGET} compiles, although it breaks its rule")
endif()
message("${output}")
