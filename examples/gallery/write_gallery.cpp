// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Program: writes a page that shows results of the other programs in a browser, in one file.

#include "Page.h"
#include "add_views.h"
#include "common/Distinct_files.h"
#include "common/Report_file.h"
#include "common/run_program.h"
#include <pcs/core/errors.h>

#include <CLI/CLI.hpp>

#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

namespace {

void declare(CLI::App& app, gallery::Options& o)
{
  app.footer(R"(Views without files are left out of the page. It needs no network and no other file.

Exit codes: 0 success, 1 bad input or usage, 2 internal error.)");
  app.set_version_flag("--version", PCS_PROGRAM_VERSION);
  app.add_option("--output", o.output, "the page (HTML)")->required();
  app.add_option("--page", o.page, "folder with the template, styles and scripts")->required();
  app.add_option("--editor", o.editor, "the live editor, compiled to one script (JavaScript)");
  CLI::Option* const rest = app.add_option("--rest", o.rest, "a model at rest");
  CLI::Option* const deformed = app.add_option("--deformed", o.deformed, "the same, deformed");
  rest->needs(deformed);
  deformed->needs(rest);
  app.add_option("--edit", o.edit, "the edit of the model (JSON); its boxes are the first handles")
      ->needs(rest);
  app.add_option("--model-up", o.model_up, "up direction of the model: y or z")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  CLI::Option* const scan =
      app.add_option("--scan", o.scan, "a scan with the branch of every point (--points)");
  CLI::Option* const cylinders =
      app.add_option("--cylinders", o.cylinders, "its cylinders (CSV)")->needs(scan);
  scan->needs(cylinders);
  app.add_option("--mesh", o.mesh, "its closed surface")->needs(scan);
  app.add_option("--scan-report", o.scan_report, "its report (JSON)")->needs(scan);
  app.add_option("--morph", o.morph, "folder with files lambda_*.ply of two trees");
  app.add_option("--family",
                 o.family,
                 "folder with files scores_*.swc of a square grid, sample_*.swc and modes.json");
  CLI::Option* const stand =
      app.add_option("--stand", o.stand, "a stand with the tree of every point");
  app.add_option("--stand-report", o.stand_report, "its report (JSON)")->needs(stand);
  app.add_option("--points", o.most_points, "largest number of points of a view")
      ->check(CLI::Range(std::size_t(1000), std::size_t(10000000)))
      ->capture_default_str();
  app.add_option("--model-points", o.most_model_points, "largest number of points of the model")
      ->check(CLI::Range(std::size_t(1000), std::size_t(10000000)))
      ->capture_default_str();
}

/// Refuses a page that would replace an input, also a file in a folder of inputs.
void check_files(const gallery::Options& o)
{
  namespace fs = std::filesystem;
  program::Distinct_files files;
  for (const std::string& input : {o.editor,
                                   o.rest,
                                   o.deformed,
                                   o.edit,
                                   o.scan,
                                   o.cylinders,
                                   o.mesh,
                                   o.scan_report,
                                   o.stand,
                                   o.stand_report})
    files.add_input(input);
  for (const std::string& folder : {o.page, o.morph, o.family}) {
    std::error_code none; // a missing folder has no files
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
      if (folder == o.page || entry.path().extension() != ".html")
        files.add_input(entry.path().string());
  }
  files.add_output(o.output);
}

bool work(const gallery::Options& o)
{
  check_files(o);
  program::Report_file file(o.output);
  gallery::Page page;
  if (!o.scan.empty())
    gallery::add_scan(o, page);
  if (!o.morph.empty())
    gallery::add_morph(o, page);
  if (!o.family.empty())
    gallery::add_family(o, page);
  if (!o.stand.empty())
    gallery::add_stand(o, page);
  if (!o.rest.empty())
    gallery::add_deformation(o, page);
  if (page.views.empty())
    throw pcs::Invalid_input("the page would be empty; name the files of at least one view, for "
                             "example --rest and --deformed");
  const std::string editor = o.editor.empty() ? std::string() : gallery::text_of_file(o.editor);
  if (!o.editor.empty() && editor.empty())
    throw pcs::IO_error(o.editor, "the file is empty");
  const std::string html = page.html(o.page, editor);
  file.commit(html);
  std::cerr << page.views.size() << " views, " << static_cast<double>(html.size() / 100000) / 10
            << " MB, " << (o.editor.empty() ? "without" : "with")
            << " the live editor: " << o.output << '\n';
  return true;
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app("Writes a page that shows results of the other programs in a browser.",
               "write_gallery");
  gallery::Options options;
  declare(app, options);
  return program::run_program(
      app,
      argc,
      argv,
      "--rest model.ply --deformed deformed.ply --page examples/gallery/page --output page.html",
      [&options] { return work(options); });
}
