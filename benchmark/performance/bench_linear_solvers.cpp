// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// The sparse Cholesky factorisation of pcs beside those of Eigen and CHOLMOD, for the matrices of a
// deformation: the Laplacian of the 6 nearest neighbours of a surface of points, plus 0.01 on the
// diagonal, with three right-hand sides. CHOLMOD (package libsuitesparse-dev) is optional.

#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <support/Table.h>
#include <support/measuring.h>
#include <support/models.h>

#include <Eigen/SparseCholesky>
#ifdef PCS_BENCH_HAS_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

using pcs_bench::number;

namespace {

using Matrix = pcs::linear_algebra::Sparse_cholesky::Matrix;
using Vec3 = Eigen::Vector3d;

/// The Laplacian of the symmetric graph of the nearest neighbours.
Matrix laplacian(const std::vector<Vec3>& points)
{
  using Metric = nanoflann::L2_Simple_Adaptor<double, pcs_bench::Neighbor_adaptor>;
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<Metric, pcs_bench::Neighbor_adaptor, 3, std::uint32_t>;
  const pcs_bench::Neighbor_adaptor adaptor{points};
  Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  constexpr std::size_t count = 7; // with the point itself
  std::vector<std::uint32_t> near(count);
  std::vector<double> distance(count);
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](std::size_t row, std::size_t column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    tree.knnSearch(points[i].data(), count, near.data(), distance.data());
    add(i, i, 0.01);
    for (const std::size_t j : near)
      if (j != i) {
        add(i, i, 1);
        add(j, j, 1);
        add(i, j, -1);
        add(j, i, -1);
      }
  }
  const auto n = static_cast<Eigen::Index>(points.size());
  Matrix result(n, n);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Seconds for the analysis of the pattern, the factorisation and the solution, and the largest
/// residual.
struct Times
{
  pcs_bench::Timings analysis, factor, solution;
  double residual = 0;
};

double residual_of(const Matrix& a, const Eigen::MatrixX3d& x, const Eigen::MatrixX3d& b)
{
  return (a * x - b).cwiseAbs().maxCoeff();
}

Times measure_pcs(const Matrix& a, const Eigen::MatrixX3d& b, int repetitions)
{
  Times times;
  for (int r = 0; r < repetitions; ++r) {
    const pcs_bench::Timer analysis;
    const auto pattern = std::make_shared<const pcs::linear_algebra::Cholesky_pattern>(a);
    times.analysis.add(analysis.seconds());
    pcs::linear_algebra::Sparse_cholesky factor;
    const pcs_bench::Timer factorisation;
    if (!factor.factorize(a, pattern))
      throw std::runtime_error("the matrix is not positive definite");
    times.factor.add(factorisation.seconds());
    std::vector<Vec3> x(static_cast<std::size_t>(b.rows())), work;
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = b.row(static_cast<Eigen::Index>(i));
    factor.solve(x, work); // allocates the work vector
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = b.row(static_cast<Eigen::Index>(i));
    const pcs_bench::Timer solution;
    factor.solve(x, work);
    times.solution.add(solution.seconds());
    Eigen::MatrixX3d result(b.rows(), 3);
    for (std::size_t i = 0; i < x.size(); ++i)
      result.row(static_cast<Eigen::Index>(i)) = x[i];
    times.residual = residual_of(a, result, b);
  }
  return times;
}

template <class Solver>
Times measure_eigen(const Matrix& of_pcs, const Eigen::MatrixX3d& b, int repetitions)
{
  const Eigen::SparseMatrix<double> a = of_pcs;
  Times times;
  for (int r = 0; r < repetitions; ++r) {
    Solver solver;
    const pcs_bench::Timer analysis;
    solver.analyzePattern(a);
    times.analysis.add(analysis.seconds());
    const pcs_bench::Timer factorisation;
    solver.factorize(a);
    times.factor.add(factorisation.seconds());
    if (solver.info() != Eigen::Success)
      throw std::runtime_error("the factorisation failed");
    const pcs_bench::Timer solution;
    const Eigen::MatrixX3d x = solver.solve(b);
    times.solution.add(solution.seconds());
    times.residual = residual_of(of_pcs, x, b);
  }
  return times;
}

} // namespace

int main(int argc, char** argv)
{
  std::vector<std::size_t> sizes{200, 1000, 5000, 35000, 170000};
  int repetitions = 3;
  std::string csv;
  CLI::App app("Sparse Cholesky factorisations beside each other.", "bench_linear_solvers");
  app.add_option("--sizes", sizes, "numbers of unknowns")->capture_default_str();
  app.add_option("--repetitions", repetitions, "number of runs; the minimum is reported")
      ->capture_default_str();
  app.add_option("--csv", csv, "write the rows to this CSV file");
  try {
    app.parse(argc, argv);
    pcs_bench::Table table(
        {"unknowns", "solver", "analysis [s]", "factorisation [s]", "solution [s]", "residual"});
    for (const std::size_t n : sizes) {
      const Matrix a = laplacian(pcs_bench::make_bumpy_figure(n));
      const Eigen::MatrixX3d b =
          Eigen::MatrixX3d::NullaryExpr(a.rows(), 3, [](Eigen::Index i, Eigen::Index j) {
            return std::sin(double(7 * i + j));
          });
      const auto add = [&](const std::string& name, const Times& t) {
        table.add({std::to_string(n),
                   name,
                   number(t.analysis.best()),
                   number(t.factor.best()),
                   number(t.solution.best()),
                   number(t.residual, 2)});
        std::cerr << n << " unknowns: " << name << '\n';
      };
      add("pcs", measure_pcs(a, b, repetitions));
      add("Eigen SimplicialLDLT",
          measure_eigen<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(a, b, repetitions));
#ifdef PCS_BENCH_HAS_CHOLMOD
      add("CHOLMOD supernodal",
          measure_eigen<Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>>>(a,
                                                                                  b,
                                                                                  repetitions));
#endif
    }
    table.print(std::cout);
    if (!csv.empty())
      table.write_csv(csv);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    std::cerr << "bench_linear_solvers: " << e.what() << '\n';
    return 1;
  }
}
