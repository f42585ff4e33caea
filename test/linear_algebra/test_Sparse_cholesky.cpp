// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Compares the sparse factor with dense algebra.

#include <pcs/linear_algebra/Sparse_cholesky.h>
#include <support/point_clouds.h>

#include <CGAL/tags.h>

#include <boost/test/unit_test.hpp>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace test_Sparse_cholesky {

namespace {

using Cholesky = pcs::linear_algebra::Sparse_cholesky;
const std::vector<std::uint32_t> any_order;

/// A sparse, symmetric, diagonally dominant matrix.
Eigen::MatrixXd random_spd(Eigen::Index n, unsigned seed)
{
  std::mt19937 random(seed);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index e = 0; e < 3 * n; ++e) {
    const auto i = static_cast<Eigen::Index>(random() % static_cast<unsigned>(n));
    const auto j = static_cast<Eigen::Index>(random() % static_cast<unsigned>(n));
    const double w = pcs_test::uniform(random);
    if (i == j)
      continue;
    a(i, j) -= w;
    a(j, i) -= w;
    a(i, i) += std::abs(w);
    a(j, j) += std::abs(w);
  }
  a.diagonal().array() += 0.1;
  return a;
}

/// Laplacian of a square grid with one fixed corner: supernodes of several columns, and fill
/// between distant ones.
Eigen::MatrixXd grid_laplacian(Eigen::Index side)
{
  const Eigen::Index n = side * side;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  const auto link = [&](Eigen::Index i, Eigen::Index j) {
    a(i, i) += 1;
    a(j, j) += 1;
    a(i, j) = a(j, i) = -1;
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i % side + 1 < side)
      link(i, i + 1);
    if (i + side < n)
      link(i, i + side);
  }
  a(0, 0) += 1;
  return a;
}

Cholesky::Matrix lower(const Eigen::MatrixXd& a)
{
  return Cholesky::Matrix(Eigen::MatrixXd(a.triangularView<Eigen::Lower>()).sparseView());
}

template <int Columns>
double largest_error(const Cholesky& factor, const Eigen::MatrixXd& a)
{
  using Row = Eigen::Matrix<double, Columns, 1>;
  std::mt19937 random(7);
  const Eigen::Index n = a.rows();
  Eigen::MatrixXd rhs(n, Columns);
  std::vector<Row> b(static_cast<std::size_t>(n)), work;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index c = 0; c < Columns; ++c)
      b[static_cast<std::size_t>(i)][c] = rhs(i, c) = pcs_test::uniform(random);
  const Eigen::MatrixXd expected = a.llt().solve(rhs);
  factor.solve(b, work);
  double error = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    error = std::max(error, (b[static_cast<std::size_t>(i)].transpose() - expected.row(i)).norm());
  return error;
}

} // namespace

BOOST_AUTO_TEST_SUITE(Sparse_cholesky)

BOOST_AUTO_TEST_CASE(solutions_agree_with_the_dense_factor_for_1_3_and_4_right_hand_sides)
{
  for (const Eigen::Index n : {1, 2, 5, 60, 300, 1000}) {
    const auto a = random_spd(n, static_cast<unsigned>(n));
    Cholesky factor;
    BOOST_REQUIRE(factor.factorize(lower(a)));
    BOOST_TEST(factor.size() == static_cast<std::size_t>(n));
    BOOST_TEST(largest_error<1>(factor, a) < 1e-11);
    BOOST_TEST(largest_error<3>(factor, a) < 1e-11);
    BOOST_TEST(largest_error<4>(factor, a) < 1e-11);
  }
}

BOOST_AUTO_TEST_CASE(a_matrix_of_size_zero_is_solved)
{
  Cholesky factor;
  BOOST_TEST(factor.factorize(Cholesky::Matrix(0, 0)));
  std::vector<Eigen::Vector3d> b, work;
  factor.solve(b, work);
  BOOST_TEST(b.empty());
  BOOST_TEST(factor.number_of_nonzeros() == 0u);
}

BOOST_AUTO_TEST_CASE(matrices_that_are_not_positive_definite_are_refused)
{
  Cholesky factor;
  Eigen::MatrixXd indefinite = Eigen::Vector3d(1, -1, 2).asDiagonal();
  BOOST_TEST(!factor.factorize(lower(indefinite)));
  Eigen::MatrixXd negative = -random_spd(20, 1);
  BOOST_TEST(!factor.factorize(lower(negative)));
  Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(3, 3);
  BOOST_TEST(!factor.factorize(lower(zero)));
  Eigen::MatrixXd hidden = Eigen::MatrixXd::Identity(2, 2); // eigenvalues -1 and 3
  hidden(0, 1) = hidden(1, 0) = 2;
  BOOST_TEST(!factor.factorize(lower(hidden)));
  Eigen::MatrixXd bad = random_spd(20, 1);
  bad(3, 3) = std::numeric_limits<double>::quiet_NaN();
  BOOST_TEST(!factor.factorize(lower(bad)));
}

BOOST_AUTO_TEST_CASE(a_missing_entry_of_the_diagonal_is_zero)
{
  using Entry = Eigen::Triplet<double>;
  const auto is_factorized = [](const std::vector<Entry>& entries) {
    Cholesky::Matrix a(3, 3);
    a.setFromTriplets(entries.begin(), entries.end());
    Cholesky factor;
    return factor.factorize(a);
  };
  BOOST_TEST(is_factorized({{0, 0, 2}, {1, 1, 2}, {2, 2, 2}, {1, 0, -0.5}}));
  BOOST_TEST(!is_factorized({{0, 0, 2}, {2, 2, 2}, {1, 0, -0.5}}));
  BOOST_TEST(!is_factorized({{0, 0, 2}, {1, 1, 2}, {1, 0, -0.5}}));
}

BOOST_AUTO_TEST_CASE(a_singular_laplacian_is_refused_in_spite_of_rounding)
{
  // A path without a prescribed node: exactly singular, but its last pivot is a rounding error.
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    const Eigen::Index n = 40;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      const double w = 1.1 + pcs_test::uniform(random);
      a(i, i) += w;
      a(i + 1, i + 1) += w;
      a(i, i + 1) = a(i + 1, i) = -w;
    }
    Cholesky factor;
    BOOST_TEST(!factor.factorize(lower(a)));
  }
}

BOOST_AUTO_TEST_CASE(sums_of_rows_keep_every_weight_of_a_chain)
{
  // Springs in series with random weights between 1e-24 and 1e24, the first of them at a fixed end.
  // A force at one node displaces the nodes by its sum over the springs before both nodes.
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const std::size_t n = 60;
    std::vector<double> weight(n);
    for (double& w : weight)
      w = std::pow(10, 24 * pcs_test::uniform(random));
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(n));
    for (Eigen::Index i = 0; i < Eigen::Index(n); ++i) {
      a(i, i) = 1; // not read, but part of the pattern
      if (i > 0)
        a(i, i - 1) = -weight[std::size_t(i)];
    }
    std::vector<double> row_sums(n, 0);
    row_sums[0] = weight[0];
    Cholesky factor;
    BOOST_REQUIRE(factor.factorize(lower(a), any_order, row_sums));
    for (const std::size_t loaded : {std::size_t(0), n / 2, n - 1}) {
      std::vector<Eigen::Matrix<double, 1, 1>> x(n, Eigen::Matrix<double, 1, 1>::Zero()), work;
      x[loaded][0] = 1;
      factor.solve(x, work);
      double expected = 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (i <= loaded)
          expected += 1 / weight[i];
        BOOST_REQUIRE(std::abs(x[i][0] - expected) < 1e-13 * expected);
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(rows_that_all_sum_to_zero_are_singular)
{
  Eigen::MatrixXd a = grid_laplacian(12);
  a(0, 0) -= 1;
  std::vector<double> row_sums(144, 0);
  Cholesky factor;
  BOOST_TEST(!factor.factorize(lower(a), any_order, row_sums));
  row_sums[77] = 1e-200;
  BOOST_TEST(factor.factorize(lower(a), any_order, row_sums));
}

BOOST_AUTO_TEST_CASE(the_factor_works_again_after_a_refusal)
{
  Cholesky factor;
  BOOST_TEST(!factor.factorize(lower(-random_spd(30, 1))));
  const auto a = random_spd(30, 2);
  BOOST_REQUIRE(factor.factorize(lower(a)));
  BOOST_TEST(largest_error<3>(factor, a) < 1e-11);
}

BOOST_AUTO_TEST_CASE(a_shared_pattern_gives_the_factor_of_the_new_values)
{
  const auto a = random_spd(50, 3);
  Eigen::MatrixXd b = 2 * a;
  b.diagonal().array() += 1;
  Cholesky factor, other;
  BOOST_REQUIRE(factor.factorize(lower(a)));
  BOOST_REQUIRE(other.factorize(lower(b), factor.pattern()));
  BOOST_TEST(largest_error<3>(factor, a) < 1e-11);
  BOOST_TEST(largest_error<3>(other, b) < 1e-11);
}

/// A matrix without zeros: the factor is one supernode.
Cholesky::Matrix full_matrix(Eigen::Index n)
{
  Eigen::MatrixXd a = Eigen::MatrixXd::Constant(n, n, -1.0 / double(n));
  a.diagonal().array() += 2;
  return lower(a);
}

BOOST_AUTO_TEST_CASE(a_factorisation_can_be_stopped_and_repeated)
{
  // Supernodes of 500 columns, and one of 900, in which another call is made.
  constexpr Eigen::Index sizes[] = {500, 500, 500, 900};
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index n = 0;
  for (const Eigen::Index size : sizes) {
    const Cholesky::Matrix a = full_matrix(size);
    for (Eigen::Index c = 0; c < a.outerSize(); ++c)
      for (Cholesky::Matrix::InnerIterator i(a, c); i; ++i)
        entries.emplace_back(int(n + i.row()), int(n + c), i.value());
    n += size;
  }
  Cholesky::Matrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  const auto pattern = std::make_shared<const pcs::linear_algebra::Cholesky_pattern>(a);
  std::vector<double> fractions;
  Cholesky factor;
  const pcs::internal::Go_on record = [&](double f) {
    fractions.push_back(f);
    return true;
  };
  BOOST_REQUIRE(factor.factorize(a, pattern, {}, record));
  BOOST_TEST(fractions.size() >= 5u);
  BOOST_TEST((std::is_sorted(fractions.begin(), fractions.end())));
  BOOST_TEST((fractions.front() >= 0 && fractions.back() <= 1));
  using Row = Eigen::Matrix<double, 1, 1>;
  const auto solution = [&](const Cholesky& f) {
    std::vector<Row> b(static_cast<std::size_t>(n), Row::Ones()), memory;
    f.solve(b, memory);
    return b;
  };
  const auto whole = solution(factor);
  for (std::size_t stop = 1; stop <= fractions.size(); ++stop) {
    std::size_t calls = 0;
    BOOST_TEST(!factor.factorize(a, pattern, {}, [&](double) { return ++calls < stop; }));
    BOOST_TEST(calls == stop);
  }
  BOOST_REQUIRE(factor.factorize(a, pattern));
  BOOST_TEST((solution(factor) == whole));
}

BOOST_AUTO_TEST_CASE(a_pattern_can_be_stopped)
{
  using Pattern = pcs::linear_algebra::Cholesky_pattern;
  const auto a = lower(grid_laplacian(8));
  int number_of_steps = 0;
  BOOST_TEST(Pattern(a, any_order, [&](double) { return ++number_of_steps > 0; }).is_complete());
  BOOST_TEST(number_of_steps >= 3);
  for (int stop = 1; stop <= number_of_steps; ++stop) {
    int calls = 0;
    BOOST_TEST(!Pattern(a, any_order, [&](double) { return ++calls < stop; }).is_complete());
    BOOST_TEST(calls == stop);
  }
  BOOST_TEST(Pattern(a).is_complete());
  BOOST_TEST(!Pattern().is_complete());
}

BOOST_AUTO_TEST_CASE(a_factor_can_be_moved)
{
  const auto a = random_spd(30, 5);
  Cholesky factor;
  BOOST_REQUIRE(factor.factorize(lower(a)));
  const Cholesky moved = std::move(factor);
  BOOST_TEST(largest_error<3>(moved, a) < 1e-11);
}

BOOST_AUTO_TEST_CASE(a_part_of_the_rows_in_the_order_of_all_has_no_more_entries)
{
  const auto a = grid_laplacian(40);
  const auto rank = pcs::linear_algebra::Cholesky_pattern::minimum_degree_order(lower(a));
  Cholesky all, part, unordered;
  BOOST_REQUIRE(all.factorize(lower(a), rank));
  BOOST_TEST(largest_error<3>(all, a) < 1e-8);
  std::vector<Eigen::Index> kept;
  std::vector<std::uint32_t> rank_of_kept, as_they_are;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (i % 7 != 3 || i > 800) {
      as_they_are.push_back(static_cast<std::uint32_t>(5 * kept.size()));
      kept.push_back(i);
      rank_of_kept.push_back(rank[static_cast<std::size_t>(i)]);
    }
  const Eigen::MatrixXd b = a(kept, kept);
  BOOST_REQUIRE(part.factorize(lower(b), rank_of_kept));
  BOOST_TEST(largest_error<3>(part, b) < 1e-8);
  BOOST_TEST(part.number_of_nonzeros() < all.number_of_nonzeros());
  BOOST_REQUIRE(unordered.factorize(lower(b), as_they_are));
  BOOST_TEST(largest_error<3>(unordered, b) < 1e-8);
  BOOST_TEST(unordered.number_of_nonzeros() > 2 * part.number_of_nonzeros());
}

BOOST_AUTO_TEST_CASE(the_factor_of_a_grid_has_few_zeros_and_keeps_columns_together)
{
  const auto a = grid_laplacian(40);
  const Eigen::Index n = a.rows();
  Cholesky factor;
  BOOST_REQUIRE(factor.factorize(lower(a)));
  BOOST_TEST(largest_error<3>(factor, a) < 1e-8);
  Eigen::SimplicialLDLT<Cholesky::Matrix> simplicial(lower(a));
  const auto exact = static_cast<std::size_t>(simplicial.matrixL().nestedExpression().nonZeros());
  BOOST_TEST(factor.number_of_nonzeros() >= exact);
  BOOST_TEST(double(factor.number_of_nonzeros()) < 1.3 * double(exact));
  BOOST_TEST(factor.pattern()->number_of_supernodes() < std::size_t(n) / 2);
}

BOOST_AUTO_TEST_CASE(subtrees_of_a_large_factor_are_solved_side_by_side_with_the_same_bits)
{
  // A grid of 160 x 160 with its diagonals, and many small ones.
  const auto grids = [](int side, int number_of_small_ones) {
    std::vector<Eigen::Triplet<double>> entries;
    int first = 0;
    const auto add_grid = [&](int size) {
      for (int i = 0; i < size * size; ++i) {
        const auto link = [&](int j) { entries.emplace_back(first + j, first + i, -1); };
        const bool has_right = i % size + 1 < size, has_next = i / size + 1 < size;
        if (has_right)
          link(i + 1);
        if (has_next)
          link(i + size);
        if (has_right && has_next)
          link(i + size + 1);
        entries.emplace_back(first + i, first + i, 6.01);
      }
      first += size * size;
    };
    add_grid(side);
    for (int k = 0; k < number_of_small_ones; ++k)
      add_grid(5);
    Cholesky::Matrix a(first, first);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
  };
  for (const auto& [side, number_of_small_ones] : {std::pair{160, 0}, {100, 2000}, {3, 8000}}) {
    const auto a = grids(side, number_of_small_ones);
    Cholesky factor;
    BOOST_REQUIRE(factor.factorize(a));
    const auto& trees = factor.pattern()->subtrees;
    BOOST_TEST(trees.subtree.size() >= 16u);
    std::vector<char> is_met(factor.pattern()->number_of_supernodes(), 0);
    for (const auto s : trees.top)
      ++is_met[s];
    for (const auto& t : trees.subtree)
      for (std::size_t s = t.begin; s < t.end; ++s)
        ++is_met[s];
    BOOST_TEST((std::count(is_met.begin(), is_met.end(), 1) == std::ptrdiff_t(is_met.size())));

    std::mt19937 random(11);
    const auto n = static_cast<std::size_t>(a.rows());
    std::vector<Eigen::Vector3d> b(n), work(3, Eigen::Vector3d::Constant(1e300));
    Eigen::MatrixXd rhs(a.rows(), 3), x(a.rows(), 3);
    for (std::size_t i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c)
        rhs(Eigen::Index(i), c) = b[i][c] = pcs_test::uniform(random);
    std::vector<Eigen::Vector3d> parallel = b, again = b, parallel_work;
    factor.solve(b, work);
    factor.solve<CGAL::Parallel_if_available_tag>(parallel, parallel_work);
    BOOST_TEST((b == parallel));
    factor.solve<CGAL::Parallel_if_available_tag>(again, work); // reuses the work arrays
    BOOST_TEST((b == again));
    for (std::size_t i = 0; i < n; ++i)
      x.row(Eigen::Index(i)) = b[i].transpose();
    const double residual = (a.selfadjointView<Eigen::Lower>() * x - rhs).norm();
    BOOST_TEST(residual < 1e-12 * rhs.norm());
  }
}

BOOST_AUTO_TEST_CASE(a_factor_with_short_values_is_as_accurate_as_these)
{
  using pcs::linear_algebra::Value_size;
  std::mt19937 random(12);
  const Eigen::Index n = 300;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < 2000; ++k) { // weights between 1e-3 and 1e3
    const auto i = Eigen::Index(random() % n), j = Eigen::Index(random() % n);
    if (i != j)
      a(i, j) = a(j, i) = -std::pow(10.0, 3 * pcs_test::uniform(random));
  }
  std::vector<double> row_sums(n, 0.1);
  for (Eigen::Index i = 0; i < n; ++i)
    a(i, i) = row_sums[std::size_t(i)] - a.row(i).sum();
  const auto matrix = lower(a);
  const auto pattern = std::make_shared<const pcs::linear_algebra::Cholesky_pattern>(matrix);
  Cholesky factor;
  const auto error = [&](Value_size size) {
    BOOST_REQUIRE(factor.factorize(matrix, pattern, row_sums, {}, size));
    return largest_error<3>(factor, a);
  };
  const double exact = error(Value_size::eight);
  BOOST_TEST(exact < 1e-11);
  const double of_six = error(Value_size::six), of_three = error(Value_size::three);
  BOOST_TEST_MESSAGE("errors " << exact << ", " << of_six << ", " << of_three);
  BOOST_TEST(of_six < 1e-11);
  BOOST_TEST(of_six != exact); // they were rounded
  BOOST_TEST(of_three < 1e-4);
  BOOST_TEST(of_three > 1e-9);
  BOOST_TEST(error(Value_size::eight) == exact);
}

BOOST_AUTO_TEST_CASE(what_stands_above_the_diagonal_is_ignored)
{
  const auto a = random_spd(60, 8);
  Cholesky factor;
  BOOST_REQUIRE(factor.factorize(Cholesky::Matrix(a.sparseView())));
  BOOST_TEST(largest_error<3>(factor, a) < 1e-11);
}

BOOST_AUTO_TEST_CASE(all_kernels_give_the_same_bits)
{
  using namespace pcs::linear_algebra;
  std::mt19937 random(9);
  for (std::size_t turn = 0; turn < 2 * 23; ++turn)
    for (const std::size_t below : {0u, 1u, 3u, 8u, 21u, 40u}) {
      const std::size_t width = 1 + turn / 2, height = width + below;
      const bool has_row_sums = turn % 2 == 1;
      Eigen::MatrixXd spd = random_spd(static_cast<Eigen::Index>(height), unsigned(width));
      Eigen::VectorXd diagonal_or_sums = spd.diagonal();
      if (has_row_sums) {
        spd = (-spd.cwiseAbs()).eval();
        spd.diagonal().setZero();
        diagonal_or_sums.setConstant(0.1);
        spd.diagonal() = diagonal_or_sums - spd.rowwise().sum();
      }
      const Eigen::MatrixXd panel = spd.leftCols(static_cast<Eigen::Index>(width));
      const auto run = [&](Factorize_front kernel, Eigen::MatrixXd& p, Eigen::MatrixXd& rest) {
        p = panel;
        rest = spd.bottomRightCorner(static_cast<Eigen::Index>(below),
                                     static_cast<Eigen::Index>(below));
        Eigen::MatrixXd scaled = p;
        Eigen::VectorXd diagonal = diagonal_or_sums;
        const bool is_regular = kernel({{p.data(), height},
                                        {scaled.data(), height},
                                        height,
                                        width,
                                        {rest.data(), below},
                                        diagonal.data(),
                                        diagonal.data() + width,
                                        has_row_sums});
        if (has_row_sums) { // the sums of the rest exclude the columns of the panel
          const Eigen::MatrixXd strict = rest.triangularView<Eigen::StrictlyLower>();
          rest.diagonal() = diagonal.tail(rest.rows()) - strict.rowwise().sum() -
                            strict.colwise().sum().transpose();
        } else
          rest.diagonal() = diagonal.tail(rest.rows());
        return is_regular;
      };
      Eigen::MatrixXd p, rest, q, other;
      BOOST_REQUIRE(run(internal::factorize_front_default, p, rest));
      // A Schur complement, up to rounding.
      const Eigen::MatrixXd l = p.bottomRows(static_cast<Eigen::Index>(below));
      const Eigen::MatrixXd expected = spd.bottomRightCorner(rest.rows(), rest.cols()) -
                                       l * p.diagonal().asDiagonal() * l.transpose();
      const Eigen::MatrixXd difference = (rest - expected).triangularView<Eigen::Lower>();
      BOOST_TEST(difference.norm() < 1e-12);
      const auto same =
          [&](Factorize_front kernel, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
            BOOST_REQUIRE(run(kernel, q, other));
            const Eigen::MatrixXd lower_q = q.triangularView<Eigen::Lower>();
            const Eigen::MatrixXd lower_a = a.triangularView<Eigen::Lower>();
            const Eigen::MatrixXd lower_other = other.triangularView<Eigen::Lower>();
            const Eigen::MatrixXd lower_b = b.triangularView<Eigen::Lower>();
            BOOST_TEST((lower_q == lower_a && lower_other == lower_b));
          };
      same(internal::factorize_front_default, p, rest);
#if PCS_HAS_RUNTIME_DISPATCH
      if (pcs::internal::has_avx2()) {
        Eigen::MatrixXd fused, fused_rest;
        BOOST_REQUIRE(run(internal::factorize_front_avx2, fused, fused_rest));
        if (pcs::internal::has_avx512())
          same(internal::factorize_front_avx512, fused, fused_rest);
      }
#endif
    }
}

BOOST_AUTO_TEST_SUITE_END()

} // namespace test_Sparse_cholesky
