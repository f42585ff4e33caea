// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compiled once: what of spaces of trees depends on no type of the caller.

#include <pcs/internal/parallel.h>
#include <pcs/shape_space/build_space_impl.h>
#include <pcs/shape_space/family/Family_points_impl.h>
#include <pcs/shape_space/family/embed_tree_impl.h>
#include <pcs/shape_space/points/Point_instances_impl.h>
#include <pcs/shape_space/statistics/tree_statistics_impl.h>

namespace pcs {
namespace shape_space {

#define PCS_INSTANTIATE(Tag)                                                                       \
  template Orl_report build_space<Tag>(const Build_options&,                                       \
                                       pcs::internal::Progress&,                                   \
                                       Space_state&);                                              \
  template Orl_report build_space_from<Tag>(const Orl_correspondences&,                            \
                                            const Build_options&,                                  \
                                            const std::string&,                                    \
                                            Space_state&);                                         \
  template Orl_correspondences store_correspondences<Tag>(const Space_state&);                     \
  template Orl_space_data store_space<Tag>(const Space_state&);                                    \
  template Space_state restore_space<Tag>(const Orl_space_data&, const std::string&);              \
  template Orl_coordinates embed_tree<Tag>(const Tree_family&, const Rooted_tree&, double*);       \
  template Orl_coordinates mean_of_family<Tag>(const Tree_family&,                                 \
                                               const std::vector<double>&,                         \
                                               Tree_mean);                                         \
  template Modes_of_variation modes_of_family<Tag>(const Tree_family&,                             \
                                                   std::size_t,                                    \
                                                   Mode_inner_product);                            \
  template Mode_coordinates project_on_modes<Tag>(const Tree_family&,                              \
                                                  const Modes_of_variation&,                       \
                                                  const Orl_coordinates&,                          \
                                                  std::size_t);                                    \
  template std::shared_ptr<const Tree_distribution> distribution_of_family<Tag>(                   \
      const Tree_family&);                                                                         \
  template bool is_distribution_of<Tag>(const Tree_family&, const Tree_distribution&);             \
  template Orl_coordinates draw_tree<Tag>(const Tree_family&,                                      \
                                          const Tree_distribution&,                                \
                                          const std::vector<Tree_descriptors>&,                    \
                                          std::uint64_t,                                           \
                                          std::uint64_t,                                           \
                                          const Tree_sampling_options&,                            \
                                          bool);

PCS_INSTANTIATE(CGAL::Sequential_tag)
#ifdef CGAL_LINKED_WITH_TBB
PCS_INSTANTIATE(CGAL::Parallel_tag)
#endif

#undef PCS_INSTANTIATE

} // namespace shape_space
} // namespace pcs
