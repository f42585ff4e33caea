/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to the deformation gradients at them, passed as
  `gradient_map`. The map is only written. Elements that the deformation does not move are not
  written, so the map should hold the identity at first.

  \par Refines
  `boost::WritablePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a 3 x 3 matrix type of Eigen

  \par Required expressions
  \code
  put(map, element, gradient);
  Gradient::RowsAtCompileTime == 3 && Gradient::ColsAtCompileTime == 3;
  typename Gradient::Scalar();
  \endcode

  \par Checked by
  `pcs::is_matrix_3_v` and `pcs::is_map_for_v`

  \par Models
  any writable property map with values of type `Eigen::Matrix3d` or `Eigen::Matrix3f`
*/
class GradientMap
{};
