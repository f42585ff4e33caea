# cmake -D INCLUDE_DIR=<dir> -P check_include_rules.cmake
#
# Reads the #include lines of all headers below <dir>/pcs and reports those that break a rule.

cmake_minimum_required(VERSION 3.21)

# The folders of pcs that a folder may include, besides itself. `root` are the headers directly in
# pcs/, `base` those of them that belong to level 0.
set(level_0 base internal)
set(level_1 ${level_0} core)
set(level_2 ${level_1} neighborhood linear_algebra splats crowns)
set(level_3 ${level_2} deformation skeleton shape_space generators)
set(base_may_include ${level_0})
set(internal_may_include ${level_0})
set(core_may_include ${level_0})
set(neighborhood_may_include ${level_1})
set(linear_algebra_may_include ${level_1})
set(splats_may_include ${level_1})
set(crowns_may_include ${level_1})
set(deformation_may_include ${level_2})
set(skeleton_may_include ${level_2})
set(shape_space_may_include ${level_2})
set(generators_may_include ${level_2})
set(registration_may_include ${level_2} base deformation)
set(root_may_include ${level_3})
set(IO_may_include ${level_1})

# Headers of CGAL packages under the GPL, as the beginning of their name; only IO/ may use them.
# The test license.no_gpl finds the indirect ones.
string(CONCAT gpl_headers "^CGAL/("
  "Kd_tree|Search_traits|Orthogonal_|Incremental_neighbor|K_neighbor|Fuzzy_|Euclidean_distance|"
  "Splitters|Point_set_|pca_estimate|jet_|mst_orient|vcm_estimate|remove_outliers|"
  "compute_average_spacing|grid_simplify|hierarchy_simplify|random_simplify|wlop_|bilateral_|"
  "cluster_point_set|estimate_scale|edge_aware|scanline_|structure_point_set|"
  "Surface_mesh_deformation|Mean_curvature_flow|extract_mean_curvature|Monge_via_jet|"
  "Polygon_mesh_processing|Surface_mesh_simplification|Surface_mesh_parameterization|"
  "AABB_|Alpha_shape|Delaunay_|Regular_triangulation|Triangulation_[23]|Triangulation_data|"
  "Heat_method|Shape_detection|Classification|Optimal_transportation|poisson_|"
  "Poisson_|Scale_space|Advancing_front|convex_hull_|IO/read_points|IO/write_points|"
  "IO/read_ply_points|IO/write_ply_points|IO/read_xyz|IO/write_xyz|IO/read_off_points|"
  "IO/write_off_points|IO/read_las|IO/write_las)")

# The rooms inside a folder of level 3, and the doors that each may open.
set(algorithms deformation skeleton shape_space)
include(${CMAKE_CURRENT_LIST_DIR}/rooms.cmake)

# Sets <room_var> to the room of a path below pcs/: `model` of pcs/skeleton/model/Axis.h, `session` of
# pcs/skeleton/Session.h, `root` of the headers at the top.
function(room_of path room_var)
  set(room root)
  if(path MATCHES "^pcs/[^/]+/([^/]+)/")
    set(room ${CMAKE_MATCH_1})
  elseif(path MATCHES "^pcs/[^/]+/")
    set(room session)
  endif()
  set(${room_var} ${room} PARENT_SCOPE)
endfunction()

# Sets `rule` to the rule about rooms that `header` breaks by including <included>, which is in <algorithm>.
function(check_rooms header included algorithm)
  set(rule "" PARENT_SCOPE)
  room_of(${header} room)
  room_of(${included} other)
  folder_of(${header} folder)
  if(folder STREQUAL algorithm AND (room STREQUAL other OR other STREQUAL "model"))
    return()
  endif()
  if(folder STREQUAL algorithm)
    set(opens ${${algorithm}_${room}})
    set(who "the room '${algorithm}/${room}'")
  else()
    set(opens ${root_${algorithm}})
    if(DEFINED ${folder}_${algorithm})
      set(opens ${${folder}_${algorithm}})
    endif()
    set(who "'${folder}'")
  endif()
  string(REGEX REPLACE "^pcs/[^/]+/" "" door ${included})
  if(NOT door IN_LIST opens AND NOT other IN_LIST opens)
    set(rule "${who} may not open '${algorithm}/${door}'; see rooms.cmake" PARENT_SCOPE)
  endif()
endfunction()

# Sets <folder_var> to the folder of a path below pcs/.
function(folder_of path folder_var)
  if(path MATCHES "^pcs/([^/]+)/")
    set(folder ${CMAKE_MATCH_1})
  elseif(path MATCHES "^pcs/(Named_function_parameters|concepts)\\.h$")
    set(folder base)
  else()
    set(folder root)
  endif()
  set(${folder_var} ${folder} PARENT_SCOPE)
endfunction()

# Sets `rule` to the rule that `header` breaks by including <included>, or to nothing.
function(check_include header included)
  folder_of(${header} folder)
  set(rule "")
  if(included MATCHES "^pcs/")
    folder_of(${included} other)
    if(NOT DEFINED ${folder}_may_include)
      set(rule "folder '${folder}' is not in the table of check_include_rules.cmake")
    elseif(NOT folder STREQUAL other AND NOT other IN_LIST ${folder}_may_include)
      set(rule "'${folder}' may not include '${other}'")
    elseif(NOT folder STREQUAL other AND included MATCHES "^pcs/[^/]+/internal/")
      set(rule "the internal folder of '${other}' is private")
    elseif(other IN_LIST algorithms)
      check_rooms(${header} ${included} ${other})
    endif()
  elseif(included STREQUAL "CGAL/basic.h" OR included STREQUAL "tbb/tbb.h")
    set(rule "includes everything; name the header that is needed")
  elseif(included MATCHES "^(tbb|oneapi)/" AND NOT header STREQUAL "pcs/internal/parallel.h")
    set(rule "only pcs/internal/parallel.h may use oneTBB: without it, code is that of CGAL::Sequential_tag")
  elseif(NOT folder STREQUAL "IO" AND included MATCHES "${gpl_headers}")
    set(rule "a CGAL package under the GPL")
  endif()
  set(rule "${rule}" PARENT_SCOPE)
endfunction()

set(number_of_broken_rules 0)
file(GLOB_RECURSE headers RELATIVE ${INCLUDE_DIR} ${INCLUDE_DIR}/pcs/*)
foreach(header IN LISTS headers)
  file(STRINGS ${INCLUDE_DIR}/${header} lines REGEX "^[ \t]*#[ \t]*include")
  foreach(line IN LISTS lines)
    if(line MATCHES "include[ \t]*<([^>]+)>")
      set(included ${CMAKE_MATCH_1})
      check_include(${header} ${included})
    else()
      set(included ${line})
      set(rule "write #include <pcs/...>, never a relative path")
    endif()
    if(rule)
      message("${header}: ${included}: ${rule}")
      math(EXPR number_of_broken_rules "${number_of_broken_rules} + 1")
    endif()
  endforeach()
endforeach()

# No folder holds more than a reader takes in at once.
set(most_headers_of_a_folder 16)
set(folders ${headers})
list(TRANSFORM folders REPLACE "/[^/]*$" "")
list(REMOVE_DUPLICATES folders)
foreach(folder IN LISTS folders)
  file(GLOB found ${INCLUDE_DIR}/${folder}/*.h)
  list(LENGTH found count)
  if(count GREATER most_headers_of_a_folder)
    message("${folder}: ${count} headers; at most ${most_headers_of_a_folder} in a folder")
    math(EXPR number_of_broken_rules "${number_of_broken_rules} + 1")
  endif()
endforeach()

list(LENGTH headers number_of_headers)
if(number_of_headers EQUAL 0)
  message(FATAL_ERROR "no headers below ${INCLUDE_DIR}/pcs")
endif()
if(number_of_broken_rules GREATER 0)
  message(FATAL_ERROR "${number_of_broken_rules} broken include rules")
endif()
message("${number_of_headers} headers keep the include rules")
