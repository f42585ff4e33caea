# cmake -D COMMANDS=<compile_commands.json> -D TARGET=<target> -D SOURCE=<source of target>
#       -D RULES=<folder of the rules> -D ERRORS=<folder> -D COMPILER=<GNU or Clang> -P check_rejected.cmake
#
# Compiles SOURCE, which must not compile: it holds many sources of RULES, or is one of them. ERRORS/<rule>.txt
# receives the first error that arises from RULES/<rule>.cpp. Fails at an error that arises from none.
#
# cmake -D RULE=<rule> -D ERRORS=<folder> -P check_rejected.cmake
#
# Prints that error.
cmake_minimum_required(VERSION 3.21)

if(RULE)
  if(NOT EXISTS ${ERRORS}/${RULE}.txt)
    message(FATAL_ERROR "${RULE}.cpp compiles, although it breaks its rule")
  endif()
  file(READ ${ERRORS}/${RULE}.txt error)
  message("${error}")
  return()
endif()

# ---- the command
file(STRINGS ${COMMANDS} lines REGEX "\"command\":.*/${TARGET}\\.dir/")
set(command "")
foreach(line IN LISTS lines)
  string(FIND "${line}" " -c ${SOURCE}\"" position)
  if(position GREATER -1)
    string(REGEX REPLACE "^.*\"command\": *" "" command "${line}")
    string(REGEX REPLACE ",[ \t]*$" "" command "${command}")
    string(JSON command GET "[${command}]" 0)
    separate_arguments(command UNIX_COMMAND "${command}")
  endif()
endforeach()
if(NOT command)
  message(FATAL_ERROR "${COMMANDS} has no command for ${SOURCE} of ${TARGET}")
endif()
list(APPEND command -fsyntax-only -ftemplate-backtrace-limit=0)
set(only_rule "")
get_filename_component(folder ${SOURCE} DIRECTORY)
if(folder STREQUAL RULES)
  get_filename_component(only_rule ${SOURCE} NAME_WE)
  list(APPEND command -Wfatal-errors)
elseif(NOT COMPILER STREQUAL "GNU")
  list(APPEND command -ferror-limit=0)
endif()

file(REMOVE_RECURSE ${ERRORS})
set(ENV{LC_ALL} C)
execute_process(COMMAND ${command} OUTPUT_VARIABLE output ERROR_VARIABLE output)

# ---- the first error of each rule
# GCC prints the chain of instantiations above an error, Clang below; both omit it if it is that of the error before.
# One of its lines names the source of the rule.
string(REGEX REPLACE "[][;\\]" "/" output "${output}") # which would join or split the items of a list
string(REPLACE "\n" ";" output "${output}")
string(REGEX REPLACE "([][+.*()^$?|\\])" "\\\\\\1" rule_regex "${RULES}")
string(APPEND rule_regex "/([A-Za-z0-9_]+)\\.cpp:[0-9]+")

set(unknown "")
function(pcs_record_error error rule)
  if(NOT rule)
    set(unknown "${unknown}${error}\n" PARENT_SCOPE)
  elseif(NOT EXISTS ${ERRORS}/${rule}.txt)
    file(WRITE ${ERRORS}/${rule}.txt "${error}")
  endif()
endfunction()

set(rule "${only_rule}") # of the chain that is being read
set(rule_before "")      # of the last chain of Clang
set(pending "")          # an error of Clang whose chain is being read
macro(pcs_record_pending)
  if(pending AND NOT rule)
    set(rule "${rule_before}")
  endif()
  if(pending)
    pcs_record_error("${pending}" "${rule}")
  endif()
  set(pending "")
endmacro()
foreach(line IN LISTS output)
  if(line MATCHES "^[^ ]*: ([a-z]+ )*error: ")
    pcs_record_pending()
    if(only_rule)
      set(rule ${only_rule})
    elseif(line MATCHES "^${rule_regex}")
      set(rule ${CMAKE_MATCH_1})
      set(rule_before "")
    elseif(NOT COMPILER STREQUAL "GNU")
      set(rule "")
    endif()
    if(COMPILER STREQUAL "GNU")
      pcs_record_error("${line}" "${rule}")
    else()
      set(pending "${line}")
    endif()
  elseif(only_rule)
    continue()
  elseif(COMPILER STREQUAL "GNU")
    if(line MATCHES "^[^ ]*: (In|At) ")
      set(rule "")
    elseif(line MATCHES "required (from|by)" AND line MATCHES "^${rule_regex}")
      set(rule ${CMAKE_MATCH_1})
    endif()
  elseif(pending AND NOT rule AND line MATCHES "^${rule_regex}:[0-9]+: note: .* requested here")
    set(rule ${CMAKE_MATCH_1})
    set(rule_before ${rule})
  endif()
endforeach()
pcs_record_pending()
if(unknown)
  message(FATAL_ERROR "errors that arise from no source of ${RULES}:\n${unknown}")
endif()
