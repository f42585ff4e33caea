// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests of reading text files.

#include "temporary_files.h"
#include <pcs/IO/Point_reader.h>

#include <boost/test/unit_test.hpp>

#include <clocale>
#include <cmath>
#include <string>
#include <vector>

namespace test_read_text {

using pcs::IO::Point_table;
using Point_3 = Point_table::Point_3;

BOOST_FIXTURE_TEST_SUITE(read_text, Temporary_files)

BOOST_AUTO_TEST_CASE(all_separators_give_the_same_points)
{
  for (const char* text : {"1 2.5 -3e2\n4 5 6\n",
                           "1\t2.5\t-3e2\n4\t5\t6\n",
                           "1,2.5,-3e2\n4, 5, 6",
                           "1;2.5;-3e2\r\n4 ; 5 ; 6\r\n",
                           "  1   2.5 -3e2  \n\n 4 5 6\n\n"}) {
    const Point_table table = read("a.xyz", text);
    BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2.5, -300), Point_3(4, 5, 6)}));
  }
}

BOOST_AUTO_TEST_CASE(columns_without_a_header_are_numbered_and_never_guessed)
{
  const Point_table table = read("a.xyz", "1 2 3 255 0 0\n4 5 6 0 nan 1\n");
  BOOST_TEST(
      (table.property_names() == std::vector<std::string>{"column_4", "column_5", "column_6"}));
  BOOST_TEST(table.property<double>("column_4")[0] == 255);
  BOOST_TEST(!table.has_normals());
}

BOOST_AUTO_TEST_CASE(a_header_names_the_columns)
{
  const Point_table table =
      read("a.csv", "# comment\n// another\n\"label\",X,Y,Z\n9,1,2,3\n# between\n8,4,5,6\n");
  BOOST_TEST((table.points()[1] == Point_3(4, 5, 6)));
  BOOST_TEST((table.property<double>("label") == std::vector<double>{9, 8}));
  BOOST_TEST(read("a.csv", "x y z\n").number_of_points() == 0u);
}

BOOST_AUTO_TEST_CASE(a_column_may_be_named_like_the_first_bytes_of_las_files)
{
  const Point_table table = read("a.csv", "LASF,x,y,z\n7,1,2,3\n");
  BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
  BOOST_TEST(table.property<double>("LASF")[0] == 7);
}

BOOST_AUTO_TEST_CASE(a_comment_before_the_first_row_may_name_the_columns)
{
  for (const char* text : {"//X Y Z wood\n1 2 3 1\n",
                           "# some scan\n# x y z wood\n1 2 3 1\n",
                           "//X,Y,Z,wood\n1,2,3,1\n",
                           "# X Y Z wood\n1;2;3;1\n",
                           "1\n//X Y Z wood\n1 2 3 1\n"}) {
    const Point_table table = read("a.txt", text);
    BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
    BOOST_TEST((table.property_names() == std::vector<std::string>{"wood"}));
  }
  for (const char* text : {"# X Y Z wood\n# another\n1 2 3 1\n", // the last header line is used
                           "# X Y Z\n1 2 3 1\n",
                           "# X Y Z 7\n1 2 3 1\n",
                           "# a b c d\n1 2 3 1\n",
                           "# x y z z\n1 2 3 1\n",
                           "1 2 3 1\n# x y z wood\n",
                           "#\n1 2 3 1\n"})
    BOOST_TEST((read("a.txt", text).property_names() == std::vector<std::string>{"column_4"}));
  const Point_table moved = read("a.txt", "# wood X Y Z\n1 2 3 4\n");
  BOOST_TEST((moved.points() == std::vector<Point_3>{Point_3(2, 3, 4)}));
}

BOOST_AUTO_TEST_CASE(the_first_column_may_have_no_name)
{
  const Point_table table = read("a.csv", ",x,y,z\n0,1,2,3\n1,4,5,6\n");
  BOOST_TEST((table.points()[1] == Point_3(4, 5, 6)));
  BOOST_TEST((table.property<double>("column_1") == std::vector<double>{0, 1}));
}

BOOST_AUTO_TEST_CASE(malformed_headers_are_refused)
{
  refuses("a.csv", "x,y,label\n1,2,3\n", "line 1: expected numbers, or the names");
  refuses("a.csv", "x,y,z,z\n1,2,3,4\n", "the column 'z' is named twice");
  refuses("a.csv", "x,y,z,Height,x\n1,2,3,4,5\n", "the column 'x' is named twice");
  refuses("a.csv", "x,y,Height,Elevation\n1,2,3,4\n", "both 'Height' and 'Elevation' may be 'z'");
  refuses("a.csv", "lon,lat,z\n1,2,3\n", "longitude and latitude are angles");
  refuses("a.csv", "x,y,z\n1,2,3,4,5\n", "line 2: expected 3 columns as in line 1, found 5");
}

BOOST_AUTO_TEST_CASE(coordinates_have_many_names_and_any_order)
{
  for (const char* names : {"Northing,Easting,Height",
                            "y_coord,x_coord,z_coord",
                            "Y [m],X [m],Z [m]",
                            "north,east,elevation",
                            "\"Y\",\"X\",\"Z\"",
                            "coordinateY,coordinateX,coordinateZ"}) {
    const Point_table table = read("a.csv", std::string(names) + "\n2,1,3\n5,4,6\n");
    BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3), Point_3(4, 5, 6)}));
  }
  const Point_table table = read("a.csv", "x,y,z,Height,Easting\n1,2,3,9,8\n");
  BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
  BOOST_TEST((table.property_names() == std::vector<std::string>{"Height", "Easting"}));
}

BOOST_AUTO_TEST_CASE(normals_have_names_in_any_letter_case)
{
  for (const char* names : {"//X Y Z Nx Ny Nz", // CloudCompare
                            "X,Y,Z,NormalX,NormalY,NormalZ",
                            "x;y;z;normal_x;normal_y;normal_z",
                            "x y z NX NY NZ"}) {
    const Point_table table = read("a.txt", std::string(names) + "\n1 2 3 0 0 1\n");
    BOOST_TEST((table.property_names() == std::vector<std::string>{"nx", "ny", "nz"}));
    BOOST_TEST((table.normals()[0] == Point_table::Vector_3(0, 0, 1)));
  }
  BOOST_TEST((read("a.txt", "x y z Nx Ny\n1 2 3 0 0\n").property_names() ==
              std::vector<std::string>{"Nx", "Ny"}));
  BOOST_TEST((read("a.txt", "x y z nx ny nz Nx\n1 2 3 0 0 1 7\n").property_names() ==
              std::vector<std::string>{"nx", "ny", "nz", "Nx"}));
}

BOOST_AUTO_TEST_CASE(tables_of_r_have_row_names_without_a_name)
{
  for (const char* text : {"\"X\" \"Y\" \"Z\"\n\"1\" 1 2 3\n\"2\" 4 5 6\n",
                           "\"\",\"X\",\"Y\",\"Z\"\n\"1\",1,2,3\n\"2\",4,5,6\n",
                           "X\tY\tZ\n1\t1\t2\t3\n2\t4\t5\t6\n"}) {
    const Point_table table = read("a.txt", text);
    BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3), Point_3(4, 5, 6)}));
    BOOST_TEST((table.property<double>("column_1") == std::vector<double>{1, 2}));
  }
  const Point_table named = read("a.txt", "\"x\" \"y\" \"z\"\n\"tree 1\" 1 2 3\n");
  BOOST_TEST((named.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
  BOOST_TEST(named.property_names().empty());
}

BOOST_AUTO_TEST_CASE(missing_values_are_nan)
{
  for (const char* word : {"NA", "nan", "NaN", "", "null", "\"NA\""}) {
    const Point_table table = read("a.csv", "x,y,z,id\n1,2,3," + std::string(word) + "\n4,5,6,7\n");
    BOOST_TEST(std::isnan(table.property<double>("id")[0]));
    BOOST_TEST(table.property<double>("id")[1] == 7);
    BOOST_TEST(table.schema().warnings.empty());
    refuses("a.csv",
            "x,y,z,id\n1,2,3,4\n1," + std::string(word) + ",3,4\n",
            "line 3: point 1: expected a finite number as coordinate y; to remove points without "
            "coordinates: awk -F',' -v OFS=',' 'NR < 2 || ($1 ~ /[0-9]/ && $2");
  }
  const Point_table tabs = read("a.txt", "x\ty\tz\tid\n1\t2\t3\t\n4\t5\t6\t7\n");
  BOOST_TEST(std::isnan(tabs.property<double>("id")[0]));
  const Point_table trailing = read("a.csv", "X;Y;Z;\n1;2;3;\n");
  BOOST_TEST(std::isnan(trailing.property<double>("column_4")[0]));
  const Point_table unnamed = read("a.csv", "X;Y;Z\n1;2;3;\n");
  BOOST_TEST((unnamed.points() == std::vector<Point_3>{Point_3(1, 2, 3)}));
}

BOOST_AUTO_TEST_CASE(columns_of_text_are_left_out_with_a_warning)
{
  const Point_table table = read("a.csv", "x,class,y,id,z\n1,NA,2,8,3\n4,\"wood, dry\",5,9,6\n");
  BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1, 2, 3), Point_3(4, 5, 6)}));
  BOOST_TEST((table.property<double>("id") == std::vector<double>{8, 9}));
  BOOST_TEST((table.property_names() == std::vector<std::string>{"id"}));
  BOOST_TEST((table.schema().warnings ==
              std::vector<std::string>{"column 'class' contains text ('\"wood, dry\"' in line 3) "
                                       "and is left out"}));
  std::string late = "x,y,z,class\n";
  for (int i = 0; i < 1000; ++i)
    late += "1,2,3,4\n";
  refuses("a.csv",
          late + "1,2,3,wood\n",
          "line 1002: expected a number of type float64 for 'class', found 'wood'; to remove the "
          "column: awk -F',' -v OFS=',' '{$4=\"\"}1' FILE > NEW_FILE");
}

BOOST_AUTO_TEST_CASE(truth_values_are_one_and_zero)
{
  const Point_table table = read("a.csv", "x,y,z,wood\n1,2,3,TRUE\n4,5,6,\"False\"\n7,8,9,1\n");
  BOOST_TEST((table.property<double>("wood") == std::vector<double>{1, 0, 1}));
  BOOST_TEST(table.schema().warnings.empty());
  const Point_table unnamed = read("a.xyz", "1 2 3 true\n4 5 6 false\n");
  BOOST_TEST((unnamed.property<double>("column_4") == std::vector<double>{1, 0}));
  refuses("a.csv", "x,y,z\n1,2,3\n4,TRUE,6\n", "found 'TRUE'");
}

BOOST_AUTO_TEST_CASE(lines_of_text_may_precede_the_first_row)
{
  for (const char* text : {"% tree\n% x y z\n1 2 3\n",
                           "Plot A;;\nX;Y;Z\n1;2;3\n",
                           "Plot 7\nX Y Z\n1 2 3\n",
                           "X Y Z\n1\n1 2 3\n",
                           "1\nX Y Z\n1 2 3\n",
                           "X,Y,Z\nm,m,m\n1,2,3\n",
                           "X Y Z\n[m] [m] [m]\n1 2 3\n"})
    BOOST_TEST((read("a.txt", text).points() == std::vector<Point_3>{Point_3(1, 2, 3)}), text);
  refuses("a.txt", "Plot A\n1 2 3\n", "line 1: expected numbers, or the names of the columns");
  refuses("a.txt", "X Y Z\na b c\n1 2 3\n", "line 2: expected the numbers of a point, or units");
  refuses("a.txt", "X Y Z\n2\n1.25 2.25 3.25\n", "declares 2 points, the file has 1");
  std::string prose;
  for (int i = 0; i < 101; ++i)
    prose += "text without numbers\n";
  refuses("a.txt", prose, "there are no numbers in the first 100 lines");
}

BOOST_AUTO_TEST_CASE(a_first_column_that_counts_the_rows_is_refused)
{
  for (const int first : {0, 1}) {
    std::string text, three;
    for (int i = 0; i < 10; ++i) {
      text += std::to_string(first + i) + " 1 2 3\n";
      three += std::to_string(first + i) + " 1 2\n";
    }
    refuses("a.txt", text, "the first column counts the rows from " + std::to_string(first));
    BOOST_TEST((read("a.txt", "# id x y z\n" + text).points()[9] == Point_3(1, 2, 3)));
    BOOST_TEST((read("a.txt", "# x y z c3\n" + text).points()[9] == Point_3(first + 9, 1, 2)));
    BOOST_TEST(read("a.txt", three).number_of_points() == 10u);
    BOOST_TEST(read("a.txt", text + "5 1 2 3\n").number_of_points() == 11u);
  }
}

BOOST_AUTO_TEST_CASE(decimal_commas_are_read_unless_commas_separate_columns)
{
  for (const char* text : {"1,5 2,5 3\n",
                           "1,5;2,5;3\n",
                           "1,5\t2,5\t3\n",
                           "x;y;z\n1,5;2,5;3\n",
                           "X\tY\tZ\n+1,5\t\"2,5\"\t3\n"}) {
    const Point_table table = read("a.xyz", text);
    BOOST_TEST((table.points() == std::vector<Point_3>{Point_3(1.5, 2.5, 3)}));
    BOOST_TEST((table.schema().warnings ==
                std::vector<std::string>{"commas in numbers are read as decimal points"}));
  }
  BOOST_TEST((read("a.csv", "1, 2, 3\n").points()[0] == Point_3(1, 2, 3)));
  refuses("a.csv", "x,y,z\n1,5,2,5,3,5\n", "with decimal commas, separate columns by semicolons");
  refuses("a.csv", "x,y,z\n1,2,\"3,5\"\n", "a decimal comma is possible if semicolons, tabs");
  refuses("a.csv", "x;y;z\n1;2;3,500,000\n", "not thousands");
  refuses("a.csv", "x;y;z\n1;2;3.500,5\n", "not thousands");
  refuses("a.csv", "x;y;z\n1.5;2;3,5\n", "decimal commas and decimal points in one line");
}

BOOST_AUTO_TEST_CASE(the_number_of_columns_is_constant)
{
  refuses("a.xyz", "1 2 3\n4 5\n", "line 2: expected 3 columns, found 2");
  refuses("a.xyz", "1 2 3\n\n4 5 6 7\n", "line 3: expected 3 columns, found 4");
  refuses("a.xyz", "1 2\n3 4\n", "line 1: expected at least three columns");
}

BOOST_AUTO_TEST_CASE(values_that_are_not_finite_numbers_are_refused)
{
  refuses("a.xyz", "1 2 3\n1 nan 3\n", "line 2: point 1: expected a finite number as coordinate y");
  refuses("a.xyz", "nan nan nan\n", "line 1");
  refuses("a.xyz", "1 2 inf\n", "line 1");
  refuses("a.xyz", "1 1e400 3\n", "out of range");
  refuses("a.xyz", "1 2 3\n1 abc 3\n", "line 2: expected a number of type float64 for 'y'");
  refuses("a.xyz", "1 2 3\n1 2.5.5 3\n", "line 2");
  refuses("a.xyz", "1 2 3\n1 0x1p3 3\n", "line 2");
}

BOOST_AUTO_TEST_CASE(the_count_of_a_pts_file_is_checked)
{
  BOOST_TEST(read("a.pts", "2\n1 2 3 9\n4 5 6 8\n").number_of_points() == 2u);
  BOOST_TEST(read("a.pts", "0\n").number_of_points() == 0u);
  refuses("a.pts", "3\n1 2 3 90\n4 5 6 8.25\n", "declares 3 points, the file has 2");
  refuses("a.pts", "1\n1 2 3 9\n4 5 6 8\n", "declares 1 points, the file has 2");
  refuses("a.pts", "4000000000\n1 2 3\n", "line 1: the file is too small");
  refuses("a.pts", "-5\n1 2 3\n", "line 1");
}

BOOST_AUTO_TEST_CASE(files_without_points_are_refused)
{
  refuses("a.xyz", "", "the file is empty");
  refuses("a.xyz", "\n# nothing\n\n", "expected a line with a point");
}

BOOST_AUTO_TEST_CASE(unknown_formats_are_refused)
{
  refuses("a.e57",
          "ASTM-E57",
          "files of type e57 are not supported; convert the file to LAS: pdal");
  refuses("a.csv.bz2", "1 2 3", "bunzip2 -k FILE");
  refuses("a.abc", "1 2 3", "unknown format 'abc'");
  refuses("a", "1 2 3", "a name without extension, expected ply");
  refuses("a.laz", "whatever", "expected 'LASF'");
}

BOOST_AUTO_TEST_CASE(a_byte_order_mark_is_skipped)
{
  BOOST_TEST((read("a.txt",
                   "\xEF\xBB\xBF"
                   "1 2 3\n")
                  .points()[0] == Point_3(1, 2, 3)));
}

BOOST_AUTO_TEST_CASE(lines_longer_than_the_buffer_are_read)
{
  std::string line = "1 2 3";
  for (int i = 0; i < 300000; ++i)
    line += ' ';
  BOOST_TEST(read("a.xyz", line + "\n" + line + "\n4 5 6\n").number_of_points() == 3u);
}

BOOST_AUTO_TEST_CASE(the_locale_of_the_program_does_not_matter)
{
  const std::string old = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8"}) // no effect if not installed
    std::setlocale(LC_ALL, locale);
  BOOST_TEST((read("a.xyz", "1.5 2.5 3.5\n").points()[0] == Point_3(1.5, 2.5, 3.5)));
  std::setlocale(LC_ALL, old.c_str());
}

BOOST_AUTO_TEST_CASE(tables_with_tabs_may_have_a_last_tab_or_blanks)
{
  const std::vector<Point_3> expected = {Point_3(1, 2, 3), Point_3(4, 5, 6), Point_3(7, 8, 9)};
  BOOST_TEST((read("a.txt", "x\ty\tz\n1\t2\t3\n4\t5\t6\t\n7 8 9  \n").points() == expected));
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_read_text
