include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(PCS_CMAKE_DIR ${CMAKE_INSTALL_DATADIR}/cmake/pcs)
configure_package_config_file(cmake/pcsConfig.cmake.in ${PROJECT_BINARY_DIR}/pcsConfig.cmake
  INSTALL_DESTINATION ${PCS_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcsConfigVersion.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)

# for build systems other than CMake
set(PCS_PC_REQUIRES "")
set(PCS_PC_FLAGS "")
set(PCS_PC_LIBRARIES "")
if(PCS_USES_TBB)
  set(PCS_PC_REQUIRES " tbb")
  set(PCS_PC_FLAGS " -DCGAL_LINKED_WITH_TBB -DPCS_WITH_TBB=1")
endif()
if(PCS_USES_LASZIP)
  string(APPEND PCS_PC_FLAGS " -DPCS_WITH_LASZIP=1")
  set(PCS_PC_LIBRARIES " -llaszip")
endif()
if(PCS_USES_ZLIB)
  string(APPEND PCS_PC_REQUIRES " zlib")
  string(APPEND PCS_PC_FLAGS " -DPCS_WITH_ZLIB=1")
endif()
configure_file(cmake/pcs.pc.in ${PROJECT_BINARY_DIR}/pcs.pc @ONLY)

set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
install(FILES ${PROJECT_BINARY_DIR}/pcs.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)
install(FILES ${PROJECT_BINARY_DIR}/include/pcs/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcs)
install(TARGETS pcs EXPORT pcsTargets)
install(EXPORT pcsTargets NAMESPACE pcs:: DESTINATION ${PCS_CMAKE_DIR})
install(DIRECTORY include/pcs DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES
  ${PROJECT_BINARY_DIR}/pcsConfig.cmake
  ${PROJECT_BINARY_DIR}/pcsConfigVersion.cmake
  cmake/pcsCompiled.cmake
  cmake/pcsFindLaszip.cmake
  cmake/pcsFindNanoflann.cmake
  DESTINATION ${PCS_CMAKE_DIR})
install(DIRECTORY cmake/compiled DESTINATION ${PCS_CMAKE_DIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
