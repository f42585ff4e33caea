// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Trees of one topology: their means, their modes of variation, new trees like them, growth and
// changes.

#ifndef PCS_ORL_TREE_FAMILY_H
#define PCS_ORL_TREE_FAMILY_H

#include <pcs/Named_function_parameters.h>
#include <pcs/Orl_tree.h>
#include <pcs/Orl_tree_set.h>
#include <pcs/core/Orl_options.h>
#include <pcs/core/errors.h>
#include <pcs/internal/Random_stream.h>
#include <pcs/shape_space/Space_engine.h>
#include <pcs/shape_space/input/check_sampling.h>
#include <pcs/shape_space/path/Growth_spline.h>
#include <pcs/shape_space/statistics/Modes_of_variation.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcs {

//! \ingroup PkgPcsShapeSpaceRef
//! what new trees are drawn from: a distribution, and the figures of the trees it was learned from
struct Orl_distribution
{
  std::shared_ptr<const shape_space::Tree_distribution> distribution; ///< null: of no space
  std::vector<shape_space::Tree_descriptors> figures;                 ///< of the inputs
};

//! \ingroup PkgPcsShapeSpaceRef
//! how a tree was drawn
struct Sample_report
{
  std::size_t number_of_trials = 0; ///< [count]
  double range_violation = 0; ///< how far its figures are beyond the inputs, 0 if they are not [-]
};

/*!
  \ingroup PkgPcsShapeSpaceRef
  \brief The trees of an `Orl_shape_space`, as points: means, modes of variation, new trees, growth,
      changes.

  The base of `Orl_shape_space`; everything here needs a space that was built, and throws
  `pcs::Invalid_input` otherwise. Means follow (4.16) and (4.17) of \cite aiteanu2022, modes and new
  trees the outlook in its section 5.2.

  \par Determinism
  Same bits for every number of threads. Of a built space nothing changes: all functions may run
  concurrently.
*/
template <class ConcurrencyTag>
class Orl_tree_family : public Orl_tree_set<ConcurrencyTag>
{
  using Set = Orl_tree_set<ConcurrencyTag>;

public:
  using Handle = typename Set::Handle;
  using Set::figures;
  using Set::number_of_trees;
  using Set::tree;

  /*!
    \brief the mean of the added trees.

    Of lengths, radii and attachments the median, of orientations the L1 mean (Weiszfeld's
    algorithm), so that the sum of distances `Orl_metric::sum` is least; the middle of an interval
    of medians. A branch that less than half of the trees have has the length 0 then. Or arithmetic
    means and Frechet means: squares of differences are least, and every branch is there, as long as
    on average.

    \npbegin
      \np{tree_mean} what is least
        \nptype `Tree_mean`
        \npdefault `median`
      \np{tree_weights} of the trees, `>= 0`, not all 0
        \nptype `std::vector<double>` of `number_of_trees()` elements
        \npdefault all 1
    \npend
    \par Complexity
    \f$O(n e)\f$ for `n` trees and `e` edges, and \f$O(n^2 e)\f$ angles for `median` up to 128
        trees.
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  Orl_tree mean(const NamedParameters& np = NamedParameters()) const
  {
    check_family("mean");
    const auto kind = pcs::internal::choose(np, pcs::internal_np::tree_mean, Tree_mean::median);
    const std::vector<double> weights =
        pcs::internal::choose(np,
                              pcs::internal_np::tree_weights,
                              std::vector<double>(number_of_trees(), 1));
    shape_space::check_tree_weights(weights,
                                    number_of_trees(),
                                    false,
                                    "pcs::Orl_shape_space::mean()");
    return make(mean_of(weights, kind), -1, weights);
  }

  /*!
    \brief the combination of the added trees with given weights.

    The weighted Frechet mean: for two trees the tree on their geodesic, for weights `>= 0` a tree
    between the inputs. Weights below 0 lead beyond the inputs; lengths stop at 0, radii at a
    hundredth of the least one among the inputs.
    \param weights one per tree; their sum is made 1 and must be positive
  */
  Orl_tree weighted_mean(const std::vector<double>& weights) const
  {
    check_family("combination");
    shape_space::check_tree_weights(weights,
                                    number_of_trees(),
                                    true,
                                    "pcs::Orl_shape_space::combination()");
    double total = 0;
    for (const double w : weights)
      total += w;
    return make(mean_of(weights, Tree_mean::frechet),
                number_of_trees() == 2 ? weights[1] / total : 0,
                weights);
  }

  //! `t`, changed by `step` times what leads from `a` to `b`: any tree, any direction [-]. Lengths
  //! end at 0, those of the trunk and radii of what is there at a hundredth of what they are in
  //! `t`.
  Orl_tree
  parallel_displacement(const Orl_tree& t, const Orl_tree& a, const Orl_tree& b, double step) const
  {
    for (const Orl_tree* x : {&t, &a, &b})
      check_tree(*x, "displaced");
    if (!std::isfinite(step))
      throw Invalid_input("pcs::Orl_shape_space::displaced(): `step` is not finite");
    return make(Engine::parallel_displacement(m_family, t.m_x, a.m_x, b.m_x, step), -1, t.m_share);
  }

  /*!
    \brief the directions in which the added trees differ most from their least-squares mean.

    Directions in the tangent space at the mean; where trees stand is left out. With all
    `number_of_trees() - 1` modes the inputs are reproduced. What makes a mode large is how branches
    differ in the trees that have them, each branch with one vote (Tyler's estimator; EM for
    branches that are not there), or the metric `Orl_metric::square`, where absent branches and long
    edges prevail: the measure for trees that differ by which branches they have, and little else.
    Where they differ by nothing else it is taken at once.
    \param most modes that are wanted; there are fewer if the trees do not differ in so many ways
    \param np
    \npbegin
      \np{mode_measure} what modes explain
        \nptype `Mode_inner_product`
        \npdefault `branches`
    \npend
    \par Complexity
    \f$O(n^4 b + n^2 e)\f$ for `n` trees, `b` branches and `e` edges, most of it for the errors of
        trees that are left out;
    memory \f$O(n e)\f$, by each thread.
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  shape_space::Modes_of_variation modes(std::size_t most,
                                        const NamedParameters& np = NamedParameters()) const
  {
    check_family("modes");
    return Engine::find_modes(m_family,
                              most,
                              pcs::internal::choose(np,
                                                    pcs::internal_np::mode_inner_product,
                                                    Mode_inner_product::branches));
  }

  //! the tree with given scores, in standard deviations of the modes; missing scores are 0. However
  //! large scores are, the trunk keeps a hundredth of its lengths in the mean at least, and so do
  //! radii where there is length.
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
    return make(Engine::tree_of_modes(m_family, modes, scores));
  }

  //! where a tree lies in the space of the modes, and how far from it; branches that it lacks do
  //! not count
  shape_space::Mode_coordinates project(const shape_space::Modes_of_variation& modes,
                                        const Orl_tree& t) const
  {
    check_modes(modes, "project");
    check_tree(t, "project");
    return Engine::project_on_modes(m_family, modes, t.m_x, modes.size());
  }

  //! the tree in the space of the first `k` modes that is nearest to `t`
  Orl_tree
  reconstruct(const shape_space::Modes_of_variation& modes, const Orl_tree& t, std::size_t k) const
  {
    check_modes(modes, "reconstruct");
    check_tree(t, "reconstruct");
    const shape_space::Mode_coordinates at = Engine::project_on_modes(m_family, modes, t.m_x, k);
    const std::vector<double> scores(at.scores.data(), at.scores.data() + at.scores.size());
    Orl_tree result = tree(modes, scores);
    result.m_x.root = t.m_x.root;
    return make(std::move(result.m_x), result.m_lambda, t.m_share);
  }

  //! how unlike the added trees a tree is: about 1 for one like them, see
  //! `shape_space::outlier_score()` [-]
  double outlier_score(const shape_space::Modes_of_variation& modes, const Orl_tree& t) const
  {
    return Engine::outlier_score(modes, project(modes, t));
  }

  //! what new trees are drawn from; learn it once, draw many
  Orl_distribution distribution() const
  {
    check_family("distribution");
    Orl_distribution result{Engine::distribution(m_family), {}};
    for (std::size_t t = 0; t < number_of_trees(); ++t)
      result.figures.push_back(figures(tree(t)));
    return result;
  }

  /*!
    \brief draws a new tree like the added ones.

    See `shape_space::Tree_distribution` for the model and `Tree_sampling_options` for what can be
    asked of the trees. Lengths and radii are positive. Trees of one family have the same topology
    and the same order of points.

    \param from what `distribution()` returned
    \param seed of the family
    \param index of the tree in its family: a tree does not depend on which others are drawn
    \npbegin
      \np{sampling_options} limits and shares
        \nptype `Tree_sampling_options`
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
        pcs::internal::choose(np, pcs::internal_np::sampling_options, Tree_sampling_options());
    check_sampling(o, "pcs::Orl_shape_space::sample()");
    if (!from.distribution || from.figures.size() != number_of_trees())
      throw Invalid_input("pcs::Orl_shape_space::sample(): the distribution is of another space");
    Orl_tree best;
    Sample_report done;
    const std::size_t trials = o.do_keep_in_range ? o.number_of_trials : 1;
    double least = 0;
    Tree_sampling_options nearer = o;
    const std::vector<double> share = draw_shares(seed, index);
    for (std::size_t k = 0; k < trials; ++k) {
      // the second half of the trials comes nearer and nearer to the middle tree, and is stretched
      // to the inputs
      nearer.spread =
          o.spread * std::min(1.0, 1.5 - static_cast<double>(k) / static_cast<double>(trials));
      // a trial is a stream of its own
      Orl_tree candidate = make(Engine::draw(m_family,
                                             *from.distribution,
                                             from.figures,
                                             pcs::internal::mix_bits(seed) + k,
                                             index,
                                             nearer,
                                             2 * k >= trials),
                                -1,
                                share);
      double beyond = 0, whole = 0; // of all figures, and of those of the tree as a whole
      if (o.do_keep_in_range) {
        const Tree_descriptors f = figures(candidate);
        beyond = Engine::range_violation(f, from.figures, true);
        whole = Engine::range_violation(f, from.figures, false);
      }
      if (k == 0 || whole < least || (whole == least && beyond < done.range_violation)) {
        best = std::move(candidate);
        done.range_violation = beyond;
        least = whole;
      }
      done.number_of_trials = k + 1;
      if (done.range_violation == 0)
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
      \np{is_monotone} whether lengths and radii must not fall; they are changed as little as
          possible for it
        \nptype `bool`
        \npdefault `false`: they do not fall where they rise in the data
    \npend
  */
  template <class NamedParameters = parameters::Default_named_parameters>
  shape_space::Growth_spline growth(const std::vector<Handle>& trees,
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
    return shape_space::Growth_spline(
        m_family.layout,
        times,
        std::move(x),
        has,
        pcs::internal::choose(np, pcs::internal_np::is_monotone, false),
        trees);
  }

  //! the tree of a path at a time; before its begin and after its end that of the begin and the end
  Orl_tree tree(const shape_space::Growth_spline& path, double time) const
  {
    check_family("tree");
    if (path.times().empty() || !std::isfinite(time))
      throw Invalid_input("pcs::Orl_shape_space::tree(): the path is empty or `time` not finite");
    shape_space::Orl_coordinates x;
    path.at(time, x);
    bool is_own = x.length.size() == m_family.layout.number_of_edges();
    for (const std::size_t h : path.scans())
      is_own = is_own && h < number_of_trees();
    if (!is_own)
      throw Invalid_input("pcs::Orl_shape_space::tree(): the path is of another space");
    return make(std::move(x), -1, shares_at(path, time));
  }

protected:
  using Set::check_family;
  using Set::check_handle;
  using Set::check_tree;
  using Set::m_family;
  using Set::make;
  using typename Set::Engine;

private:
  /// Those of the scans before and after a time.
  std::vector<double> shares_at(const shape_space::Growth_spline& path, double time) const
  {
    std::vector<double> result(number_of_trees(), 0);
    const auto [k, f] = path.place(time);
    result[path.scans()[k]] += 1 - f;
    result[path.scans()[std::min(k + 1, path.scans().size() - 1)]] += f;
    return result;
  }

  /// Evenly from all shares that add up to a whole.
  std::vector<double> draw_shares(std::uint64_t seed, std::uint64_t index) const
  {
    pcs::internal::Random_stream random(pcs::internal::mix_bits(~seed), index);
    std::vector<double> result(number_of_trees());
    for (double& s : result)
      s = -std::log(1 - random.uniform());
    return result;
  }

  void check_modes(const shape_space::Modes_of_variation& modes, const char* caller) const
  {
    check_family(caller);
    if (modes.mean.length.size() != m_family.layout.number_of_edges() ||
        modes.mean.attachment.size() != m_family.layout.branches.size())
      throw Invalid_input(std::string("pcs::Orl_shape_space::") + caller +
                          "(): the modes are of another space");
  }

  shape_space::Orl_coordinates mean_of(const std::vector<double>& weights, Tree_mean kind) const
  {
    return Engine::mean_tree(m_family, weights, kind);
  }
};

} // namespace pcs

#endif // PCS_ORL_TREE_FAMILY_H
