# The rooms of the three algorithms: who may include whom. Read by check_include_rules.cmake; the page
# doc/user_manual/architecture.md shows it as figures.
#
# A header in include/pcs/<algorithm>/<room>/ may include its own room, <algorithm>/model/, the levels below, and the
# doors that are listed here for its room, as <room>/<header> or as <room> for all headers of a room. Headers directly
# in <algorithm>/ (the session) and the public headers at the top may include what `<algorithm>_session` and `root` list.


# ---- deformation: deform_point_set
set(root_deformation Session.h access)
set(deformation_session
  body/Sampled_body.h
  body/Sampled_body_impl.h
  handles/Handle_set.h
  handles/Target_field.h
  handles/constrain_body.h
  handles/set_targets.h
  multigrid/Coarse_levels.h
  solver/Elastic_solver.h
  upsampling/Dirty_handles.h
  upsampling/Handle_fades.h
  upsampling/Outlier_maps.h
  upsampling/Point_carrier.h
  upsampling/Rest_positions.h
  upsampling/Target_corrections.h
  upsampling/Upsampling.h
  upsampling/find_target_corrections.h
  upsampling/read_maps.h
  upsampling/write_points.h)
set(deformation_handles body/Sample_regions.h body/Sampled_body.h)
set(deformation_multigrid
  body/Sample_links.h
  body/Sample_regions.h
  body/interior_links.h
  body/octree_samples.h
  handles/add_boundary_nodes.h
  handles/anchor_free_components.h
  solver/Elastic_solver.h)
set(deformation_upsampling
  body/Sample_links.h
  body/Sample_regions.h
  body/Sampled_body.h
  handles/Border_finder.h
  handles/Handle_set.h
  handles/Site_constraints.h
  handles/Target_field.h
  solver/Elastic_state.h)

# The registration deforms the samples of a body by its own solver.
set(registration_deformation
  access
  body/Sampled_body.h
  body/Sampled_body_impl.h
  body/octree_samples.h
  model)

# ---- skeleton: extract_tree_skeleton, segment_trees
set(root_skeleton
  Resampled_session.h
  Session.h
  forest/Stand.h
  input/Session_hints.h
  input/caller_types.h
  input/check_input.h
  input/read_maps.h
  input/read_options.h
  resampling/resample_scan.h
  result/skeleton_warnings.h
  result/write_points.h
  result/write_result.h
  surface/Surface_builder.h)
set(skeleton_session
  axes/fit_axes.h
  branching/build_branch_tree.h
  clutter/remove_clutter.h
  continuation/continue_hidden_trunk.h
  continuation/find_coarse_axes.h
  continuation/follow_thick_ends.h
  input/Session_hints.h
  layers/trace_layers.h
  leaves/find_leaf_blades.h
  leaves/separate_leaves.h
  radii/refine_radii.h
  registration/register_stations.h
  resampling/Copy_descriptors.h
  resampling/resample_scan.h
  result/describe_tree.h
  scan/Point_labels.h
  scan/thin_dense_points.h
  slices/section_skeleton.h
  stages)
set(skeleton_stages
  Session_options.h
  Session_state.h
  axes/reassign_points.h
  branching/level_set_skeleton.h
  scan/measure_coordinate_step.h
  scan/prepare_scan.h
  scan/thin_dense_points.h
  slices/section_skeleton.h)
set(skeleton_branching clutter/Ground.h)
set(skeleton_clutter
  graph/Neighbor_graph.h
  graph/shortest_paths.h
  layers/Stem_foot.h
  scan/Point_labels.h
  scan/leave_out_strays.h)
set(skeleton_layers graph/Neighbor_graph.h graph/shortest_paths.h)
set(skeleton_axes graph/Neighbor_graph.h layers/cut_layers.h)
set(skeleton_continuation
  axes/Axis_fit.h
  axes/Chain_options.h
  axes/fit_axes.h
  axes/remove_axes.h
  graph/Neighbor_links.h
  layers/trace_layers.h
  scan/prepare_scan.h)
set(skeleton_radii axes/Axis_fit.h axes/Axis_oval.h)
set(skeleton_leaves graph/Neighbor_graph.h graph/shortest_paths.h scan/Voxel_cells.h)
set(skeleton_slices layers/cut_layers.h)
set(skeleton_result Session.h input/caller_types.h)
set(skeleton_forest
  Session.h
  Session_options.h
  axes/fit_axes.h
  branching/build_branch_tree.h
  graph/Neighbor_graph.h
  graph/shortest_paths.h
  input/Session_hints.h
  layers/trace_layers.h
  result/describe_tree.h
  scan/leave_out_strays.h)

# ---- shape_space: orl_geodesic, Orl_shape_space
set(root_shape_space
  Orl_tree.h
  Space_state.h
  build_space.h
  family/embed_tree.h
  input/check_sampling.h
  input/check_space.h
  input/read_options.h
  input/tree_input.h
  input/write_skeleton.h
  measures/Tree_descriptors.h
  measures/change_table.h
  model/Orl_coordinates.h
  path/Growth_spline.h
  path/interpolate_trees.h
  points/write_points.h
  statistics/Modes_of_variation.h
  statistics/make_tree.h
  statistics/tree_statistics.h)
set(shape_space_session
  family/Family_points.h
  family/build_family.h
  family/make_family.h
  family/serialize_family.h
  input/tree_input.h
  pair/Embedded_pair.h
  pair/build_pair.h
  pair/embed_pair.h
  pair/serialize_topology.h
  path/Tree_state.h
  points/Point_instances_impl.h)
set(shape_space_embedding matching/align_vectors.h)
set(shape_space_points transport/partial_transport.h)
set(shape_space_pair
  embedding/embed_trees.h
  embedding/refine_yaw.h
  embedding/skip_fold_edges.h
  input/tree_input.h
  matching/Branch_matching.h
  matching/Match_confidences.h
  matching/build_topology.h
  matching/count_whorls.h
  matching/find_yaw_candidates.h
  points/Point_instances.h
  points/assign_points.h
  points/point_correspondences.h
  points/surface_patches.h)
set(shape_space_family
  embedding/embed_trees.h
  embedding/mean_rotation.h
  input/tree_input.h
  matching/build_topology.h
  matching/count_whorls.h
  matching/elastic_curves.h
  matching/find_yaw_candidates.h
  measures/Tree_descriptors.h
  pair/Embedded_pair.h
  pair/serialize_topology.h
  points/Point_instances.h
  points/Point_instances_impl.h
  points/assign_points.h
  points/point_correspondences.h
  points/surface_patches.h
  points/tube_coordinates.h)
set(shape_space_statistics
  embedding/mean_rotation.h
  measures/Tree_descriptors.h
  path/Tree_state.h
  path/apply_pipe_model.h)
