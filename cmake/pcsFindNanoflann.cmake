# Defines nanoflann::nanoflann, from nanoflann's own configuration file or from the header alone.

if(NOT TARGET nanoflann::nanoflann)
  find_package(nanoflann QUIET CONFIG)
endif()
if(NOT TARGET nanoflann::nanoflann)
  find_path(PCS_NANOFLANN_INCLUDE_DIR nanoflann.hpp)
  if(PCS_NANOFLANN_INCLUDE_DIR)
    add_library(nanoflann::nanoflann INTERFACE IMPORTED)
    target_include_directories(nanoflann::nanoflann INTERFACE "${PCS_NANOFLANN_INCLUDE_DIR}")
  endif()
endif()
