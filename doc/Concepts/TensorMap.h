/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to 3 x 3 tensors that the deformation transforms,
  passed as `tensor_map`.

  \par Refines
  `boost::ReadWritePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a 3 x 3 matrix type of Eigen

  \par Required expressions
  \code
  Tensor t = get(map, element);
  put(map, element, t);
  Tensor::RowsAtCompileTime == 3 && Tensor::ColsAtCompileTime == 3;
  typename Tensor::Scalar();
  \endcode

  \par Checked by
  `pcs::is_matrix_3_v` and `pcs::is_read_write_map_v`

  \par Models
  any read-write property map with values of type `Eigen::Matrix3d` or `Eigen::Matrix3f`
*/
class TensorMap
{};
