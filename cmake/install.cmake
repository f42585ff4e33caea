include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(PCS_CMAKE_DIR ${CMAKE_INSTALL_DATADIR}/cmake/pcs)
configure_package_config_file(cmake/pcsConfig.cmake.in ${PROJECT_BINARY_DIR}/pcsConfig.cmake
  INSTALL_DESTINATION ${PCS_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcsConfigVersion.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)

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
