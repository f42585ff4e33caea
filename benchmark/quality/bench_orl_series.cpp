// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Plants seen at three times: the middle predicted from the ends, against linear morphing and against no change.

#include <support/growth_series.h>

#include <CLI/CLI.hpp>

#include <cstdio>

using namespace orl_test;

namespace {

void print(const std::string& what, double lambda, const Prediction& p)
{
  std::printf("| %s | %.2f | %.3f | %.3f | %.3f | %.3f |\n",
              what.c_str(),
              lambda,
              p.geodesic,
              p.linear,
              p.first,
              p.last);
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
  std::string data;
  CLI::App app("Chamfer distances of predictions to what was seen.");
  app.add_option("--data", data, "folder with tomato_series and skel_collections")->required();
  CLI11_PARSE(app, argc, argv);
  std::printf("| plant | lambda | geodesic | linear | first end | last end |\n"
              "|---|---|---|---|---|---|\n");
  const std::string days[] = {"03-05", "03-06", "03-08", "03-10"};
  const double day[] = {0, 1, 3, 5};
  std::vector<Seen_plant> tomato;
  for (std::size_t i = 0; i < 4; ++i)
    tomato.push_back(read_plant(data + "/tomato_series/" + days[i] + (i < 2 ? ".xyz" : ".ply"),
                                data + "/tomato_series/" + days[i] + ".graph.txt",
                                40000));
  const std::size_t triples[][3] = {{0, 2, 3}, {0, 1, 3}, {0, 1, 2}, {1, 2, 3}};
  for (const auto& [a, m, b] : triples) {
    const double lambda = (day[m] - day[a]) / (day[b] - day[a]);
    print("tomato " + days[a] + " " + days[m] + " " + days[b],
          lambda,
          predict(tomato[a], tomato[m], tomato[b], lambda, Vec3::UnitZ()));
  }
  std::vector<Seen_plant> european;
  for (const std::string age : {"y", "m", "a"})
    european.push_back(
        read_model(data + "/skel_collections/EU06" + age + "_postProcessing_max.txtskl",
                   40000,
                   static_cast<unsigned>(european.size())));
  for (const double lambda : {0.3, 0.5, 0.7})
    print("EU06 young medium adult",
          lambda,
          predict(european[0], european[1], european[2], lambda, Vec3::UnitY()));
  return 0;
}
