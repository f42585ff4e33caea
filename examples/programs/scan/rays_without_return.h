// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Removes the rays without return from a ray cloud.

#ifndef PCS_EXAMPLES_PROGRAMS_SCAN_RAYS_WITHOUT_RETURN_H
#define PCS_EXAMPLES_PROGRAMS_SCAN_RAYS_WITHOUT_RETURN_H

#include <pcs/IO/points/Point_table.h>

#include <cstddef>
#include <string>
#include <vector>

namespace program {

/*!
  Removes rays without return from a ray cloud of raycloudtools, where their `alpha` is 0 and their
  position is an arbitrary point in the air. Returns their number. Ray clouds have both `alpha` and
  `time`; other files, and colours with an alpha of 0 throughout, are unchanged.
*/
inline std::size_t remove_rays_without_return(pcs::IO::Point_table& table)
{
  if (!table.has_property("alpha") || !table.has_property("time"))
    return 0;
  const std::vector<double> alpha = table.property_as_double("alpha");
  std::vector<std::size_t> returns;
  for (std::size_t i = 0; i < alpha.size(); ++i)
    if (alpha[i] != 0)
      returns.push_back(i);
  if (returns.empty() || returns.size() == alpha.size())
    return 0;
  table = table.select(returns);
  return alpha.size() - returns.size();
}

/// Returns the warning about rays without return.
inline std::string warning_of_rays(std::size_t number_of_rays)
{
  return std::to_string(number_of_rays) + " rays without return (alpha 0) were left out";
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_SCAN_RAYS_WITHOUT_RETURN_H
