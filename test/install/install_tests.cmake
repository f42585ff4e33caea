# The ways in which a user's project gets pcs. Each one builds and runs install/consumer.

get_target_property(eigen_include_dir Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(ways find_package add_subdirectory copied_headers)
find_program(PCS_DPKG dpkg)
find_program(PCS_PKG_CONFIG pkg-config)
if(PCS_DPKG AND PCS_PKG_CONFIG)
  list(APPEND ways debian_package)
endif()
foreach(way IN LISTS ways)
  add_test(NAME install.${way} COMMAND ${CMAKE_COMMAND}
    -D WAY=${way}
    -D PCS_ROOT=${PROJECT_SOURCE_DIR}
    -D PCS_BUILD=${PROJECT_BINARY_DIR}
    -D WORK_DIR=${CMAKE_CURRENT_BINARY_DIR}/install/${way}
    -D GENERATOR=${CMAKE_GENERATOR}
    -D CXX=${CMAKE_CXX_COMPILER}
    -D PCS_WITH_TBB=${PCS_WITH_TBB}
    -D EIGEN_INCLUDE_DIR=${eigen_include_dir}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/install/use_pcs.cmake)
  set_tests_properties(install.${way} PROPERTIES LABELS "static;install;long")
endforeach()
