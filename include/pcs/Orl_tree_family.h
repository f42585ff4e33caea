// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees of one topology: their means, their modes of variation, new trees like them, growth and changes.

#ifndef PCS_ORL_TREE_FAMILY_H
#define PCS_ORL_TREE_FAMILY_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_tree.h>
#include <pcs/core/errors.h>
#include <pcs/internal/text.h>
#include <pcs/shape_space/Tree_distribution.h>
#include <pcs/shape_space/Tree_family.h>
#include <pcs/shape_space/change_table.h>
#include <pcs/shape_space/growth_path.h>
#include <pcs/shape_space/mean_tree.h>
#include <pcs/shape_space/modes_of_variation.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! what new trees are drawn from: a distribution, and the figures of the trees it was learned from
struct Orl_distribution
{
  shape_space::Tree_distribution distribution;
  std::vector<shape_space::Tree_figures> figures; ///< of the inputs
};

//! \ingroup PkgPcsShapeSpaceRef
//! how a tree was drawn
struct Sample_report
{
  std::size_t number_of_trials = 0; ///< [count]
  double excess = 0; ///< how far its figures are beyond the inputs, 0 if they are not [-]
};

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The trees of an `Orl_shape_space`, as points: means, modes of variation, new trees, growth, changes.

  The base of `Orl_shape_space`; everything here needs a space that was built, and throws `pcs::Invalid_input` otherwise.
  Means follow (4.16) and (4.17) of \cite aiteanu2022, modes and new trees the outlook in its section 5.2.

  \par Determinism
  Same bits for every number of threads. Of a built space nothing changes: all functions may run concurrently.
*/
template <class ConcurrencyTag>
class Orl_tree_family
{
public:
  //! names an added tree
  using Handle = std::size_t;

  //! trees that were added when the space was built [count]
  std::size_t number_of_trees() const { return m_family.x.size(); }

  //! an added tree as a tree of the space
  Orl_tree tree(Handle h) const
  {
    check_handle(h, "tree");
    return make(m_family.x[h], h == 1 ? 1 : 0);
  }

  //! whether tree `h` has branch `b` of the topology
  bool has_branch(Handle h, std::size_t b) const
  {
    check_handle(h, "has_branch");
    return b < m_family.has[h].size() && m_family.has[h][b] != 0;
  }

  //! the number of the vertex at the tip of branch `b` in the graph of tree `h`, `npos` if it does not have it
  std::size_t tip_of_branch(Handle h, std::size_t b) const
  {
    return has_branch(h, b) ? m_family.tip[h][b] : npos;
  }

  /*!
    \brief the distance between two trees of the space.

    \npbegin
      \np{metric} sum of differences as in (4.7), root of their squares, or edges as vectors
        \nptype `shape_space::Orl_metric`
        \npdefault `sum`
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(const Orl_tree& a,
                  const Orl_tree& b,
                  const NamedParameters& np = NamedParameters()) const
  {
    check_tree(a, "distance");
    check_tree(b, "distance");
    return distance_of(a.m_x, b.m_x, np);
  }
  //! the same between two added trees
  template <class NamedParameters = parameters::Default_named_parameters>
  double distance(Handle a, Handle b, const NamedParameters& np = NamedParameters()) const
  {
    check_handle(a, "distance");
    check_handle(b, "distance");
    return distance_of(m_family.x[a], m_family.x[b], np);
  }

  //! distances of all pairs of added trees, row by row: that of `a` and `b` is at `a * number_of_trees() + b` [L]
  template <class NamedParameters = parameters::Default_named_parameters>
  std::vector<double> distances(const NamedParameters& np = NamedParameters()) const
  {
    check_family("distances");
    const std::size_t n = number_of_trees();
    std::vector<double> result(n * n, 0);
    pcs::internal::for_each_index<ConcurrencyTag>(
        n,
        [&](std::size_t a) {
          for (std::size_t b = 0; b < a; ++b)
            result[a * n + b] = distance_of(m_family.x[a], m_family.x[b], np);
        },
        1);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b)
        result[b * n + a] = result[a * n + b];
    return result;
  }

  /*!
    \brief the mean of the added trees.

    Of lengths, radii and attachments the median, of orientations the L1 mean (Weiszfeld's algorithm), so that the sum of
    distances `Orl_metric::sum` is least; the middle of an interval of medians. A branch that less than half of the trees
    have has the length 0 then. Or arithmetic means and Frechet means: squares of differences are least, and every
    branch is there, as long as on average.

    \npbegin
      \np{tree_mean} what is least
        \nptype `shape_space::Tree_mean`
        \npdefault `least_sum`
      \np{tree_weights} of the trees, `>= 0`, not all 0
        \nptype `std::vector<double>` of `number_of_trees()` elements
        \npdefault all 1
    \npend
    \par Complexity
    \f$O(n e)\f$ for `n` trees and `e` edges, and \f$O(n^2 e)\f$ angles for `least_sum` up to 128 trees.
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree mean(const NamedParameters& np = NamedParameters()) const
  {
    check_family("mean");
    const auto kind =
        pcs::internal::choose(np, pcs::internal_np::tree_mean, shape_space::Tree_mean::least_sum);
    const std::vector<double> weights =
        pcs::internal::choose(np,
                              pcs::internal_np::tree_weights,
                              std::vector<double>(number_of_trees(), 1));
    check_weights(weights, false, "mean");
    return make(mean_of(weights, kind));
  }

  /*!
    \brief the combination of the added trees with given weights.

    The weighted Frechet mean: for two trees the tree on their geodesic, for weights `>= 0` a tree between the inputs.
    Weights below 0 lead beyond the inputs; lengths and radii stop at 0.
    \param weights one per tree; their sum is made 1 and must be positive
  */
  Orl_tree combination(const std::vector<double>& weights) const
  {
    check_family("combination");
    check_weights(weights, true, "combination");
    double total = 0;
    for (const double w : weights)
      total += w;
    return make(mean_of(weights, shape_space::Tree_mean::least_squares),
                number_of_trees() == 2 ? weights[1] / total : 0);
  }

  //! `t`, changed by `step` times what leads from `a` to `b`: any tree, any direction [-]
  Orl_tree displaced(const Orl_tree& t, const Orl_tree& a, const Orl_tree& b, double step) const
  {
    for (const Orl_tree* x : {&t, &a, &b})
      check_tree(*x, "displaced");
    if (!std::isfinite(step))
      throw Invalid_input("pcs::Orl_shape_space::displaced(): `step` is not finite");
    using shape_space::Tangent_space;
    // turns are carried over in the frames of the edges themselves
    const Tangent_space from(m_family.layout, a.m_x, m_family.weights);
    const Tangent_space at(m_family.layout, t.m_x, m_family.weights);
    shape_space::Orl_coordinates x = at.exp(step * from.log(b.m_x));
    x.root = t.m_x.root + step * (b.m_x.root - a.m_x.root);
    return make(std::move(x));
  }

  /*!
    \brief the directions in which the added trees differ most from their least-squares mean.

    Principal components in the tangent space at the mean, in units of the metric `Orl_metric::square`; where trees stand
    is left out. With all `number_of_trees() - 1` modes the inputs are reproduced.
    \param most modes that are wanted; there are fewer if the trees do not differ in so many ways
    \par Complexity
    \f$O(n^2 e + n^4)\f$ for `n` trees and `e` edges, memory \f$O(n e)\f$.
  */
  shape_space::Modes_of_variation modes(std::size_t most) const
  {
    check_family("modes");
    const std::vector<double> ones(number_of_trees(), 1);
    return shape_space::find_modes<ConcurrencyTag>(
        m_family.layout,
        pointers(),
        m_family.weights,
        mean_of(ones, shape_space::Tree_mean::least_squares),
        most);
  }

  //! the tree with given scores, in standard deviations of the modes; missing scores are 0
  Orl_tree tree(const shape_space::Modes_of_variation& modes,
                const std::vector<double>& scores) const
  {
    check_modes(modes, "tree");
    if (scores.size() > modes.size())
      throw Invalid_input("pcs::Orl_shape_space::tree(): " + std::to_string(scores.size()) +
                          " scores for " + std::to_string(modes.size()) + " modes");
    for (const double s : scores)
      if (!std::isfinite(s))
        throw Invalid_input("pcs::Orl_shape_space::tree(): a score is not finite");
    return make(shape_space::tree_of_modes(m_family.layout, m_family.weights, modes, scores));
  }

  //! where a tree lies in the space of the modes, and how far from it
  shape_space::Mode_coordinates project(const shape_space::Modes_of_variation& modes,
                                        const Orl_tree& t) const
  {
    check_modes(modes, "project");
    check_tree(t, "project");
    return shape_space::project_on_modes(m_family.layout, m_family.weights, modes, t.m_x);
  }

  //! the tree in the space of the first `k` modes that is nearest to `t`
  Orl_tree
  reconstruct(const shape_space::Modes_of_variation& modes, const Orl_tree& t, std::size_t k) const
  {
    const shape_space::Mode_coordinates at = project(modes, t);
    std::vector<double> scores(at.scores.data(), at.scores.data() + at.scores.size());
    scores.resize(std::min(k, scores.size()));
    Orl_tree result = tree(modes, scores);
    result.m_x.root = t.m_x.root;
    return make(std::move(result.m_x), result.m_lambda);
  }

  //! how unlike the added trees a tree is: about 1 for one like them, see `shape_space::outlier_score()` [-]
  double outlier_score(const shape_space::Modes_of_variation& modes, const Orl_tree& t) const
  {
    return shape_space::outlier_score(modes, project(modes, t));
  }

  //! what new trees are drawn from; learn it once, draw many
  Orl_distribution distribution() const
  {
    check_family("distribution");
    Orl_distribution result{
        shape_space::Tree_distribution(m_family.layout, pointers(), m_family.has, ConcurrencyTag()),
        {}};
    for (std::size_t t = 0; t < number_of_trees(); ++t)
      result.figures.push_back(figures(tree(t)));
    return result;
  }

  /*!
    \brief draws a new tree like the added ones.

    See `shape_space::Tree_distribution` for the model and `shape_space::Sampling_options` for what can be asked of the
    trees. Lengths and radii are positive. Trees of one family have the same topology and the same order of points.

    \param from what `distribution()` returned
    \param seed of the family
    \param index of the tree in its family: a tree does not depend on which others are drawn
    \npbegin
      \np{sampling_options} limits and shares
        \nptype `shape_space::Sampling_options`
    \npend
    \param report if not null, how the tree was found
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree sample(const Orl_distribution& from,
                  std::uint64_t seed,
                  std::uint64_t index,
                  const NamedParameters& np = NamedParameters(),
                  Sample_report* report = nullptr) const
  {
    check_family("sample");
    using namespace shape_space;
    const auto o =
        pcs::internal::choose(np, pcs::internal_np::sampling_options, Sampling_options());
    check_options(o);
    if (from.figures.size() != number_of_trees())
      throw Invalid_input("pcs::Orl_shape_space::sample(): the distribution is of another space");
    Orl_tree best;
    Sample_report done;
    const std::size_t trials = o.do_keep_in_range ? o.number_of_trials : 1;
    for (std::size_t k = 0; k < trials; ++k) {
      // a trial is a stream of its own
      Orl_coordinates x = from.distribution.draw(pcs::internal::mix_bits(seed) + k, index, o);
      if (o.pipe_exponent > 0)
        limit_pipes(m_family.layout, o.pipe_exponent, x);
      if (o.do_limit_radii)
        limit_radii(m_family.layout, x);
      Orl_tree candidate = make(std::move(x));
      const double beyond = o.do_keep_in_range ? excess(figures(candidate), from.figures) : 0;
      if (k == 0 || beyond < done.excess) {
        best = std::move(candidate);
        done.excess = beyond;
      }
      done.number_of_trials = k + 1;
      if (done.excess == 0)
        break;
    }
    if (report)
      *report = done;
    return best;
  }

  //! the same once; for more than one tree keep the `distribution()`
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree sample(std::uint64_t seed, const NamedParameters& np = NamedParameters()) const
  {
    return sample(distribution(), seed, 0, np);
  }

  /*!
    \brief a smooth path through added trees, in the order given.

    \param trees at least 2
    \param times increasing, one per tree
    \npbegin
      \np{is_monotone} whether lengths and radii must not fall; they are changed as little as possible for it
        \nptype `bool`
        \npdefault `false`: they do not fall where they rise in the data
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  shape_space::Growth_path growth(const std::vector<Handle>& trees,
                                  const std::vector<double>& times,
                                  const NamedParameters& np = NamedParameters()) const
  {
    check_family("growth");
    const auto fail = [](const std::string& what) {
      throw Invalid_input("pcs::Orl_shape_space::growth(): " + what);
    };
    if (trees.size() < 2 || times.size() != trees.size())
      fail(std::to_string(trees.size()) + " trees and " + std::to_string(times.size()) +
           " times, expected at least 2 and as many");
    std::vector<shape_space::Orl_coordinates> x;
    std::vector<std::vector<char>> has;
    for (std::size_t i = 0; i < trees.size(); ++i) {
      check_handle(trees[i], "growth");
      if (!std::isfinite(times[i]) || (i > 0 && !(times[i] > times[i - 1])))
        fail("times must be finite and increase");
      x.push_back(m_family.x[trees[i]]);
      has.push_back(m_family.has[trees[i]]);
    }
    return shape_space::Growth_path(
        m_family.layout,
        times,
        std::move(x),
        has,
        pcs::internal::choose(np, pcs::internal_np::is_monotone, false));
  }

  //! the tree of a path at a time; before its begin and after its end that of the begin and the end
  Orl_tree tree(const shape_space::Growth_path& path, double time) const
  {
    check_family("tree");
    if (path.times().empty() || !std::isfinite(time))
      throw Invalid_input("pcs::Orl_shape_space::tree(): the path is empty or `time` not finite");
    shape_space::Orl_coordinates x;
    path.at(time, x);
    if (x.length.size() != m_family.layout.number_of_edges())
      throw Invalid_input("pcs::Orl_shape_space::tree(): the path is of another space");
    return make(std::move(x));
  }

  /*!
    \brief what became of each branch from tree `a` to tree `b`: new, lost, longer, thicker, turned.

    \npbegin
      \np{change_limits} when a difference counts
        \nptype `shape_space::Change_limits`
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  std::vector<shape_space::Branch_change>
  changes(Handle a, Handle b, const NamedParameters& np = NamedParameters()) const
  {
    check_handle(a, "changes");
    check_handle(b, "changes");
    const auto limits =
        pcs::internal::choose(np, pcs::internal_np::change_limits, shape_space::Change_limits());
    for (const double x : {limits.length, limits.radius, limits.angle})
      if (!(x >= 0))
        throw Invalid_input("pcs::Orl_shape_space::changes(): a limit is " +
                            pcs::internal::to_text(x) + ", expected at least 0");
    return shape_space::find_changes(m_family.layout, m_family.x[a], m_family.x[b], limits);
  }

  //! length, height, width, branches and angles of a tree; height is measured along `growth_direction()`
  shape_space::Tree_figures figures(const Orl_tree& t) const
  {
    check_tree(t, "figures");
    return shape_space::measure(m_family.layout, t.m_x, t.m_geometry, m_family.up);
  }

  //! unit vector from the roots to the middle of the trees: upwards, if they grow that way
  const shape_space::Vec3& growth_direction() const { return m_family.up; }
  //! the topology, for callers who look inside; \pre it was built
  const shape_space::Orl_layout& layout() const { return m_family.layout; }
  //! weights of the metric; \pre it was built
  const shape_space::Orl_weights& weights() const { return m_family.weights; }

protected:
  void check_family(const char* caller) const
  {
    if (m_family.x.empty())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): call build() first");
  }
  void check_handle(Handle h, const char* caller) const
  {
    check_family(caller);
    if (h >= number_of_trees())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller + "(): there is no tree " +
                          std::to_string(h));
  }
  void check_tree(const Orl_tree& t, const char* caller) const
  {
    check_family(caller);
    if (t.m_x.length.size() != m_family.layout.number_of_edges() ||
        t.m_x.attachment.size() != m_family.layout.branches.size())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): the tree is of another space");
  }

  /// `lambda` is the share of the second of two trees; negative: as the coordinates tell.
  Orl_tree make(shape_space::Orl_coordinates x, double lambda = -1) const
  {
    Orl_tree result;
    result.m_x = std::move(x);
    result.m_lambda = lambda >= 0              ? lambda
                      : number_of_trees() == 2 ? share_of_second(result.m_x)
                                               : 0;
    shape_space::build_geometry(m_family.layout,
                                result.m_x,
                                m_family.orientation,
                                result.m_geometry);
    m_family.find_offsets(result.m_x, result.m_offset);
    return result;
  }

  shape_space::Tree_family m_family;

private:
  template <class NamedParameters>
  double distance_of(const shape_space::Orl_coordinates& a,
                     const shape_space::Orl_coordinates& b,
                     const NamedParameters& np) const
  {
    return shape_space::distance(
        a,
        b,
        m_family.weights,
        pcs::internal::choose(np, pcs::internal_np::metric, shape_space::Orl_metric::sum));
  }

  void check_modes(const shape_space::Modes_of_variation& modes, const char* caller) const
  {
    check_family(caller);
    if (modes.mean.length.size() != m_family.layout.number_of_edges() ||
        modes.mean.attachment.size() != m_family.layout.branches.size())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): the modes are of another space");
  }

  void check_weights(const std::vector<double>& w, bool may_be_negative, const char* caller) const
  {
    const auto fail = [&](const std::string& what) {
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller + "(): " + what);
    };
    if (w.size() != number_of_trees())
      fail(std::to_string(w.size()) + " weights for " + std::to_string(number_of_trees()) +
           " trees");
    double total = 0, size = 0;
    for (const double x : w) {
      if (!std::isfinite(x) || (x < 0 && !may_be_negative))
        fail("a weight is " + pcs::internal::to_text(x) +
             (may_be_negative ? ", expected finite numbers" : ", expected numbers >= 0"));
      total += x;
      size += std::abs(x);
    }
    if (!(total > 1e-9 * size))
      fail("the sum of the weights must be positive");
  }

  static void check_options(const shape_space::Sampling_options& o)
  {
    const auto check = [](bool is_right, const char* what) {
      if (!is_right)
        throw Invalid_input(std::string("pcs::Orl_shape_space::sample(): ") + what);
    };
    check(o.truncation > 0, "`truncation` must be > 0");
    check(o.spread >= 0 && std::isfinite(o.spread), "`spread` must be >= 0 and finite");
    check(o.shrinkage <= 1, "`shrinkage` must be at most 1");
    check(o.number_of_trials > 0, "`number_of_trials` must be at least 1");
    check(o.pipe_exponent >= 0 && std::isfinite(o.pipe_exponent),
          "`pipe_exponent` must be >= 0 and finite");
  }

  std::vector<const shape_space::Orl_coordinates*> pointers() const
  {
    std::vector<const shape_space::Orl_coordinates*> result;
    for (const shape_space::Orl_coordinates& x : m_family.x)
      result.push_back(&x);
    return result;
  }

  shape_space::Orl_coordinates mean_of(const std::vector<double>& weights,
                                       shape_space::Tree_mean kind) const
  {
    return shape_space::mean_tree<ConcurrencyTag>(m_family.layout, pointers(), weights, kind);
  }

  /// The place of the nearest tree on the geodesic of two trees, in [0, 1].
  double share_of_second(const shape_space::Orl_coordinates& x) const
  {
    const shape_space::Tangent_space tangent(m_family.layout, m_family.x[0], m_family.weights);
    const Eigen::VectorXd way = tangent.log(m_family.x[1]);
    const double length = way.squaredNorm();
    return length > 0 ? std::min(1.0, std::max(0.0, tangent.log(x).dot(way) / length)) : 0;
  }
};

} // namespace pcs

#endif // PCS_ORL_TREE_FAMILY_H
