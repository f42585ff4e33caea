# What of pcs depends on no type of the caller, compiled once in the build tree of whoever links to it, with its flags:
# pcs::compiled, or pcs::compiled_<part> for one algorithm. Without them, every source that includes pcs compiles it.

option(PCS_COMPILED_OPTIMIZE "Optimise pcs::compiled also in Debug builds and without a build type" ON)
set(PCS_COMPILED_PARTS deformation io shape_space skeleton)
if(NOT TARGET pcs_compiled)
  add_library(pcs_compiled INTERFACE)
  add_library(pcs::compiled ALIAS pcs_compiled)
  foreach(part IN LISTS PCS_COMPILED_PARTS)
    add_library(pcs_compiled_${part} STATIC EXCLUDE_FROM_ALL
      ${CMAKE_CURRENT_LIST_DIR}/compiled/${part}.cpp)
    add_library(pcs::compiled_${part} ALIAS pcs_compiled_${part})
    target_link_libraries(pcs_compiled_${part} PUBLIC pcs::pcs)
    if(PCS_COMPILED_OPTIMIZE AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
      target_compile_options(pcs_compiled_${part} PRIVATE $<$<OR:$<CONFIG:>,$<CONFIG:Debug>>:-O2>)
    endif()
    string(TOUPPER ${part} macro)
    target_compile_definitions(pcs_compiled_${part} INTERFACE PCS_COMPILED_${macro})
    set_target_properties(pcs_compiled_${part} PROPERTIES
      POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
    target_link_libraries(pcs_compiled INTERFACE pcs_compiled_${part})
  endforeach()
endif()
