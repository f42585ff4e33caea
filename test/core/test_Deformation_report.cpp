// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of printing reports and errors.

#include <pcs/core/Deformation_report.h>
#include <pcs/core/errors.h>

#include <boost/test/unit_test.hpp>

#include <set>
#include <sstream>
#include <string>

namespace test_Deformation_report {

BOOST_AUTO_TEST_SUITE(Deformation_report)

BOOST_AUTO_TEST_CASE(every_status_has_a_name_of_its_own)
{
  std::set<std::string> names;
  for (const auto status : {pcs::Status::converged,
                            pcs::Status::iteration_limit,
                            pcs::Status::nothing_to_do,
                            pcs::Status::cancelled,
                            pcs::Status::numerical_failure}) {
    std::ostringstream out;
    out << status;
    BOOST_TEST(out.str() == pcs::to_string(status));
    names.insert(out.str());
  }
  BOOST_TEST(names.size() == 5u);
  BOOST_TEST(names.count("unknown") == 0u);
}

BOOST_AUTO_TEST_CASE(a_report_prints_its_counts)
{
  pcs::Deformation_report report;
  report.status = pcs::Status::converged;
  report.number_of_points = 12345;
  report.number_of_samples = 678;
  report.sample_choice = pcs::Sample_choice::all_points;
  report.number_of_unreached_points = 91;
  report.energy = 0.25;
  std::ostringstream out;
  out << report;
  for (const char* word :
       {"converged", "12345 points", "678 samples (all points)", "91 points", "0.25"})
    BOOST_TEST(out.str().find(word) != std::string::npos, out.str() << " lacks " << word);
}

BOOST_AUTO_TEST_CASE(a_file_error_names_its_file)
{
  const pcs::IO_error error("cloud.ply", "line 3: expected a number");
  BOOST_TEST(error.file_name() == "cloud.ply");
  BOOST_TEST(std::string(error.what()) == "cloud.ply: line 3: expected a number");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Deformation_report
