// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Tests the program deform_point_set with invalid input: exit code 1, a helpful message, no file is
// changed.

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cstddef>
#include <examples/Program_run.h>
#include <random>
#include <string>
#include <vector>

namespace test_program_errors {

namespace {

const std::string arguments =
    "--input in.ply --edit edit.json --output out.ply --report report.json";

/// Runs `arguments`, which must fail with these words in a message of one or two lines. Files must
/// be unchanged.
void refuses(Deform_run& program,
             const std::string& args,
             const std::vector<std::string>& words,
             const std::string& what)
{
  program.write("out.ply", "an old file");
  const std::size_t number_of_files = program.number_of_files();
  const int code = program.run(args);
  BOOST_TEST(code == 1, what << ": exit code " << code << ", " << program.err);
  for (const std::string& word : words)
    BOOST_TEST(program.err.find(word) != std::string::npos,
               what << ": '" << word << "' is missing in '" << program.err << "'");
  const auto lines = std::count(program.err.begin(), program.err.end(), '\n');
  BOOST_TEST((lines == 1 || lines == 2), what << ": " << lines << " lines, " << program.err);
  BOOST_TEST(program.err.size() < 600, what << ": " << program.err);
  BOOST_TEST(program.out == "", what);
  BOOST_TEST(program.content("out.ply") == "an old file", what << ": the old output was touched");
  BOOST_TEST(program.number_of_files() == number_of_files, what << ": files came or went");
}

void refuses_edit(Deform_run& program, const std::string& edit, std::vector<std::string> words)
{
  program.write("edit.json", edit);
  words.push_back("edit.json: ");
  refuses(program, arguments, words, edit.substr(0, 200));
}

/// Same, for a handle at /handles/1 after a valid one.
void refuses_handle(Deform_run& program,
                    const std::string& handle,
                    const std::vector<std::string>& words)
{
  refuses_edit(program,
               R"({"handles": [{"select": {"property": "status", "equals": 0}, "fixed": true}, )" +
                   handle + "]}",
               words);
}

const std::string head = R"("select": {"property": "status", "equals": 9})";

} // namespace

BOOST_AUTO_TEST_SUITE(edit_errors)

BOOST_FIXTURE_TEST_CASE(what_is_no_json_is_refused, Deform_run)
{
  refuses_edit(*this, "", {"empty"});
  refuses_edit(*this, "{", {"not valid JSON", "line 1"});
  refuses_edit(*this, R"({"handles": NaN})", {"not valid JSON"});
  refuses_edit(*this, R"({"handles": [1e999]})", {"not valid JSON", "1e999"});
  refuses_edit(*this, "{\"a\": \"\xff\"}", {"not valid JSON", "UTF-8"});
  refuses_edit(*this, std::string(1, '\0'), {"not valid JSON"});
  refuses_edit(*this, std::string(1000000, '['), {"not valid JSON"});
  refuses_edit(*this,
               std::string(100000, '[') + std::string(100000, ']'),
               {"top level: expected an object", "array of length 1"});
  refuses_edit(*this, R"({"handles": [], "handles": []})", {"\"handles\"", "twice"});
}

BOOST_FIXTURE_TEST_CASE(the_top_level_is_checked, Deform_run)
{
  refuses_edit(*this, "[]", {"top level: expected an object with handles, found an array"});
  refuses_edit(*this, "{}", {"the key handles is missing"});
  refuses_edit(*this,
               R"({"handles": {}})",
               {"/handles: expected an array with at least one handle, found an object"});
  refuses_edit(*this,
               R"({"handles": []})",
               {"/handles: expected an array with at least one handle"});
  refuses_edit(*this, R"({"handels": []})", {"unknown key \"handels\", expected handles"});
  refuses_edit(*this, R"({"handles": [7]})", {"/handles/0: expected an object", "found 7"});
}

BOOST_FIXTURE_TEST_CASE(a_turn_that_is_too_large_is_refused_with_its_handle, Deform_run)
{
  refuses_handle(*this,
                 "{" + head + R"(, "rotate": {"axis": [0, 0, 1], "degrees": 1e15}})",
                 {"edit.json: /handles/1: ", "a turn by"});
}

BOOST_FIXTURE_TEST_CASE(a_selection_is_checked, Deform_run)
{
  refuses_handle(*this, R"({"fixed": true})", {"/handles/1: the key select is missing"});
  const auto refuses_select = [&](const std::string& select,
                                  const std::vector<std::string>& words) {
    refuses_handle(*this, R"({"select": )" + select + R"(, "fixed": true})", words);
  };
  refuses_select("{}", {"/handles/1/select: expected exactly one of", "found 0"});
  refuses_select(R"({"indices": [1], "box": [[0, 0, 0], [1, 1, 1]]})",
                 {"/handles/1/select: expected exactly one", "found 2"});
  refuses_select(R"({"all": true})", {"/handles/1/select: unknown key \"all\""});
  refuses_select(R"({"box": [[0, 0, 0]]})",
                 {"/handles/1/select/box: expected [[x, y, z], [x, y, z]]", "length 1"});
  refuses_select(R"({"box": [[0, 0, 0], [1, 1]]})",
                 {"/handles/1/select/box/1: expected [x, y, z]"});
  refuses_select(R"({"box": [[0, 0, 0], [1, 1, "1"]]})",
                 {"/handles/1/select/box/1/2: expected a number, found \"1\""});
  refuses_select(R"({"box": [[0, 0, 0], [1, 1, 1]]})",
                 {"/handles/1/select: selects none of the 2100 points", "lie between"});
  refuses_select(R"({"sphere": {"center": [0, 0, 0]}})",
                 {"/handles/1/select/sphere: the key radius is missing"});
  refuses_select(R"({"sphere": {"center": [0, 0, 0], "radius": -1}})",
                 {"/handles/1/select/sphere/radius: expected a number > 0, found -1"});
  refuses_select(R"({"sphere": {"centre": [0, 0, 0], "radius": 1}})", {"unknown key \"centre\""});
  refuses_select(R"({"sphere": {"center": [0, 0, 0], "radius": 1}})",
                 {"/handles/1/select: selects none"});
  refuses_select(R"({"property": "status"})",
                 {"/handles/1/select: property and equals belong together"});
  refuses_select(R"({"property": 3, "equals": 3})",
                 {"/handles/1/select/property: expected the name"});
  refuses_select(R"({"property": "status", "equals": "2"})",
                 {"/handles/1/select/equals: expected a number, found \"2\""});
  refuses_select(R"({"property": "class", "equals": 2})",
                 {"/handles/1/select/property: there is no property \"class\"", "status"});
  refuses_select(R"({"property": "status", "equals": 99})", {"/handles/1/select: selects none"});
  refuses_select(R"({"indices": []})", {"/handles/1/select: selects none"});
  refuses_select(R"({"indices": 4})", {"/handles/1/select/indices: expected an array"});
  refuses_select(R"({"indices": [4, 2100]})",
                 {"/handles/1/select/indices/1: there is no point 2100, the input has 2100"});
  refuses_select(R"({"indices": [4, -1]})",
                 {"/handles/1/select/indices/1: expected a point number", "found -1"});
  refuses_select(R"({"indices": [4, 1.5]})",
                 {"/handles/1/select/indices/1: expected a point number", "found 1.5"});
  refuses_select(R"({"indices": [99999999999999999999]})",
                 {"/handles/1/select/indices/0: expected a point number"});
  refuses_select(R"({"indices": [18446744073709551615]})",
                 {"/handles/1/select/indices/0: there is no point"});
}

BOOST_FIXTURE_TEST_CASE(targets_are_checked, Deform_run)
{
  const auto refuses_targets = [&](const std::string& indices,
                                   const std::string& targets,
                                   const std::vector<std::string>& words) {
    refuses_handle(*this,
                   R"({"select": {"indices": )" + indices + R"(}, "targets": )" + targets + "}",
                   words);
  };
  refuses_targets("[1990]", "7", {"/handles/1/targets: expected an array of positions"});
  refuses_targets("[1990, 1995]",
                  "[[0, 0, 0]]",
                  {"/handles/1/targets: expected one position for each of the 2 indices, found 1"});
  refuses_targets("[1990]", "[[0, 0]]", {"/handles/1/targets/0: expected [x, y, z]"});
  refuses_targets("[1990, 1995, 1990]",
                  "[[0, 0, 0], [0, 0, 1], [0, 0, 2]]",
                  {"/handles/1/targets: point 1990 is listed twice"});
  refuses_targets("[1990]", "[[0, 0, 1e300]]", {"/handles/1: ", "extents of the cloud away"});
  refuses_handle(*this,
                 "{" + head + R"(, "targets": [[0, 0, 0]]})",
                 {"/handles/1/targets: needs select with indices"});
  refuses_handle(*this,
                 R"({"select": {"indices": [1990]}, "targets": [[0, 0, 0]], "scale": 2})",
                 {"/handles/1: expected exactly one of fixed, matrix, targets"});
  write("edit.json", R"({"handles": [{"select": {"indices": [1990]}, "targets": [[0, 0, 0]]}]})");
  refuses(*this,
          arguments + " --stream",
          {"edit.json: /handles/0/targets: --stream keeps only some", "run without --stream"},
          "targets of a stream");
}

BOOST_FIXTURE_TEST_CASE(a_motion_is_checked, Deform_run)
{
  const auto refuses_motion = [&](const std::string& motion,
                                  const std::vector<std::string>& words) {
    refuses_handle(*this, "{" + head + motion + "}", words);
  };
  refuses_motion("", {"/handles/1: expected exactly one of fixed, matrix"});
  refuses_motion(R"(, "fixed": true, "scale": 2)",
                 {"/handles/1: expected exactly one of fixed, matrix"});
  refuses_motion(R"(, "fixed": false)", {"/handles/1/fixed: expected true, found false"});
  refuses_motion(R"(, "fixed": 1)", {"/handles/1/fixed: expected true, found 1"});
  refuses_motion(R"(, "rotat": 1)", {"/handles/1: unknown key \"rotat\""});
  refuses_motion(R"(, "rotate": 40)",
                 {"/handles/1/rotate: expected an object with axis, degrees, center, found 40"});
  refuses_motion(R"(, "rotate": {"degrees": 4})", {"/handles/1/rotate: the key axis is missing"});
  refuses_motion(R"(, "rotate": {"axis": [0, 0, 1]})",
                 {"/handles/1/rotate: the key degrees is missing"});
  refuses_motion(R"(, "rotate": {"axis": [0, 0, 0], "degrees": 4})",
                 {"/handles/1/rotate/axis: expected a direction"});
  refuses_motion(R"(, "rotate": {"axis": [0, 0], "degrees": 4})",
                 {"/handles/1/rotate/axis: expected [x, y, z]"});
  refuses_motion(R"(, "rotate": {"axis": [0, 0, 1], "degrees": "4"})",
                 {"/handles/1/rotate/degrees: expected a number"});
  refuses_motion(R"(, "rotate": {"axis": [0, 0, 1], "degrees": 4, "radians": 1})",
                 {"/handles/1/rotate: unknown key"});
  refuses_motion(R"(, "translate": [0, 0, null])",
                 {"/handles/1/translate/2: expected a number, found null"});
  refuses_motion(R"(, "scale": 0)", {"/handles/1/scale: expected a number > 0, found 0"});
  refuses_motion(R"(, "scale": -2)", {"/handles/1/scale: expected a number > 0"});
  refuses_motion(R"(, "scale": [1, 1, 1])",
                 {"/handles/1/scale: expected a number > 0, found an array"});
  refuses_motion(R"(, "fixed": true, "softness": -1)",
                 {"/handles/1/softness: expected a number >= 0"});
  refuses_motion(R"(, "fixed": true, "softness": true)",
                 {"/handles/1/softness: expected a number >= 0, found true"});
  refuses_motion(R"(, "matrix": [1, 0, 0])",
                 {"/handles/1/matrix: expected 16 numbers", "length 3"});
  refuses_motion(R"(, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2])",
                 {"/handles/1/matrix: the last row"});
  refuses_motion(R"(, "matrix": [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])",
                 {"/handles/1/matrix: ", "uniform scale"});
  refuses_motion(R"(, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])",
                 {"/handles/1/matrix: ", "determinant"});
  refuses_motion(R"(, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,{}, 0,0,0,1])",
                 {"/handles/1/matrix/11: expected a number"});
  refuses_motion(R"(, "translate": [1e308, 1e308, 1e308])", {"edit"});
  refuses_motion(R"(, "scale": 1e308, "translate": [1e308, 0, 0])", {"edit"});
}

BOOST_FIXTURE_TEST_CASE(overlapping_handles_are_named_with_the_number_of_points, Deform_run)
{
  refuses_handle(
      *this,
      R"({"select": {"indices": [150, 199, 200, 300]}, "fixed": true})",
      {"/handles/0 and /handles/1 overlap: both select 2 points, the first is number 150"});
  refuses_handle(
      *this,
      R"({"select": {"indices": [199]}, "fixed": true}, {"select": {"indices": [199]},
"scale": 2})",
      {"/handles/0 and /handles/1 overlap: both select 1 point, number 199", "1 more pair"});
}

BOOST_FIXTURE_TEST_CASE(one_place_in_two_handles_is_refused, Deform_run)
{
  input.points()[1999] = input.points()[0];
  pcs::IO::write_points(path("in.ply"), input);
  refuses_handle(*this,
                 R"({"select": {"indices": [1999]}, "scale": 2})",
                 {"/handles/1: ", "point 1999", "same place"});
}

// Checks only that there is no crash and no internal error.
BOOST_FIXTURE_TEST_CASE(mutated_edits_end_with_success_or_one_message, Deform_run)
{
  pcs::IO::write_points(
      path("in.ply"),
      Table(std::vector<Table::Point_3>(input.points().begin(), input.points().begin() + 60)));
  const std::string edit =
      R"({"handles":[{"select":{"indices":[0,1,2]},"fixed":true,"softness":1},{"select":{"box":[[0,0,5],[2e3,9,7]]},)"
      R"("rotate":{"axis":[0,1,0],"degrees":30,"center":[1,2,3]},"translate":[1,0,0],
"scale":1.5}]})";
  const std::vector<std::string> pieces =
      {"-1", "1e308", "-1e308", "1e-320", "null", "[]", "{}", "\"\"", "0", "true", ",", "}", "]"};
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) {
    std::string mutated = edit;
    const std::size_t at = random() % mutated.size();
    if (k % 2)
      mutated.replace(at, 1 + random() % 3, pieces[random() % pieces.size()]);
    else { // replaces a number by a number, so that more edits pass the parser
      const std::size_t digit = mutated.find_first_of("0123456789", at);
      if (digit != std::string::npos)
        mutated.replace(digit, 1, pieces[random() % 4]);
    }
    write("edit.json", mutated);
    const int code = run(arguments);
    BOOST_TEST((code == 0 || code == 1), code << " for " << mutated << ": " << err);
    BOOST_TEST(((code == 0) == err.empty()), mutated << ": " << err);
  }
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(usage_errors)

BOOST_FIXTURE_TEST_CASE(without_arguments_there_is_an_example, Deform_run)
{
  BOOST_TEST(run("") == 1);
  for (const char* word : {"Deforms a point cloud", "Example: deform_point_set --input", "--help"})
    BOOST_TEST(err.find(word) != std::string::npos, word << " in " << err);
  BOOST_TEST(std::count(err.begin(), err.end(), '\n') == 3);
}

BOOST_FIXTURE_TEST_CASE(the_command_line_is_checked, Deform_run)
{
  write("edit.json", edit_of({parse("{" + head + R"(, "fixed": true})")}).dump());
  const auto refuses_usage = [&](const std::string& args, const std::vector<std::string>& words) {
    refuses(*this, args, words, args);
  };
  refuses_usage("--default-edit", {"--input is required"});
  refuses_usage("--input in.ply --default-edit", {"--output is required"});
  refuses_usage("--input in.ply --output out.ply", {"exactly one of --edit and --default-edit"});
  refuses_usage(arguments + " --default-edit", {"exactly one of --edit and --default-edit"});
  for (const char* number : {"0", "-5", "99999999999999999999", "1.5", "many", "\"\""})
    refuses_usage(arguments + " --samples " + number, {"--samples"});
  for (const char* number : {"0", "1", "61", "-2"})
    refuses_usage(arguments + " --neighbors " + number, {"--neighbors"});
  refuses_usage(arguments + " --sample 3", {"--sample"});
  refuses_usage(arguments + " extra", {"extra"});
}

BOOST_FIXTURE_TEST_CASE(files_are_checked_before_the_work, Deform_run)
{
  write("edit.json", edit_of({parse("{" + head + R"(, "fixed": true})")}).dump());
  const std::string in = "--input in.ply --edit edit.json";
  const auto refuses_files = [&](const std::string& args, const std::vector<std::string>& words) {
    refuses(*this, args, words, args);
  };
  refuses_files("--input no.ply --edit edit.json --output out.ply", {"no.ply"});
  refuses_files("--input . --edit edit.json --output out.ply", {"."});
  refuses_files("--input in.ply --edit no.json --output out.ply", {"no.json: cannot be opened"});
  refuses_files("--input in.ply --edit . --output out.ply", {"expected an edit in JSON"});
  refuses_files(in + " --output no/out.ply", {"no/out.ply: cannot be opened for writing"});
  refuses_files(in + " --output .", {"."});
#ifndef PCS_WITH_LASZIP
  refuses_files(in + " --output out.laz", {"out.laz", "LASzip"});
#endif
  refuses_files(in + " --output out.ply.gz", {"out.ply.gz", "gzip FILE"});
  refuses_files(in + " --output out.ply --report r.json.gz", {"r.json.gz", "gzip FILE"});
  refuses_files(in + " --output out", {"out: a name without extension"});
  refuses_files(in + " --output out.off", {"out.off", "OFF cannot store the property"});
  refuses_files(in + " --output out.ply --report no/report.json",
                {"no/report.json: cannot be opened for writing"});
  refuses_files(in + " --output out.ply --report .", {"directory"});
  refuses_files(in + " --output out.ply --report in.ply",
                {"--report and --input are the same file"});
  refuses_files(in + " --output out.ply --report ./edit.json",
                {"--report and --edit are the same file"});
  refuses_files(in + " --output out.ply --report ./out.ply",
                {"--report and --output are the same file"});
  refuses_files(in + " --output out2.ply --report \"$PWD/out2.ply\"", // neither exists
                {"--report and --output are the same file"});
  refuses_files(in + " --output edit.json", {"--output and --edit are the same file"});
  BOOST_TEST(exists("edit.json"));
}

BOOST_FIXTURE_TEST_CASE(clouds_that_cannot_be_deformed_are_refused, Deform_run)
{
  write("edit.json", R"({"handles": [{"select": {"indices": [0]}, "translate": [1, 0, 0]}]})");
  const auto refuses_cloud =
      [&](const std::string& text, const std::string& edit, const std::string& word) {
        write("in.xyz", text);
        refuses(*this, "--input in.xyz --output out.ply " + edit, {word}, edit + " on " + text);
      };
  for (const std::string edit : {"--default-edit", "--edit edit.json"}) {
    const std::string by = edit == "--default-edit" ? "in.xyz" : ""; // or the edit
    refuses_cloud("", edit, "in.xyz: the file is empty");
    refuses_cloud("# nothing\n", edit, "in.xyz");
    refuses_cloud("1 2 3\n", edit, by);
    refuses_cloud("1 2 3\n1 2 3\n1 2 3\n", edit, by);
    refuses_cloud("1 2 3\nnan 2 3\n", edit, "in.xyz");
    refuses_cloud("-1e308 0 0\n1e308 0 0\n0 1 0\n", edit, by);
    refuses_cloud("1e308 0 0\n1e308 1e308 0\n0 1 0\n", edit, by);
    refuses_cloud("1 2\n", edit, "in.xyz");
  }
  write("in.ply",
        "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n");
  refuses(*this,
          "--input in.ply --output out.ply --default-edit",
          {"in.ply"},
          "a header that lies");
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_program_errors
