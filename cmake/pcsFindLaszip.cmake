# Defines pcs_laszip, the library LASzip with its C interface, if it is found.

if(NOT TARGET pcs_laszip)
  find_path(PCS_LASZIP_INCLUDE_DIR NAMES laszip/laszip_api.h laszip_api.h)
  find_library(PCS_LASZIP_LIBRARY laszip)
  if(PCS_LASZIP_INCLUDE_DIR AND PCS_LASZIP_LIBRARY)
    add_library(pcs_laszip INTERFACE IMPORTED)
    target_include_directories(pcs_laszip INTERFACE "${PCS_LASZIP_INCLUDE_DIR}")
    target_link_libraries(pcs_laszip INTERFACE "${PCS_LASZIP_LIBRARY}")
  endif()
endif()
