/*!
  \ingroup PkgPcsConcepts
  \cgalConcept

  A property map from the elements of a range to vectors that the deformation transforms, passed as
  `vector_map`.

  \par Refines
  `boost::ReadWritePropertyMap`

  \par Required types
  `boost::property_traits<Map>::value_type`, a type `Vector` with three coordinates

  \par Required expressions
  \code
  Vector v = get(map, element);
  put(map, element, v);
  v.x(); v.y(); v.z();
  Vector w(FT(), FT(), FT());
  \endcode

  \par Checked by
  `pcs::is_point_or_vector_v` and `pcs::is_read_write_map_v`

  \par Archetype
  `Map_archetype<Triple_archetype<FT>>` in `test/support/archetypes.h`

  \par Models
  any read-write property map with values of type `Kernel::Vector_3` or `Eigen::Vector3d`
*/
class VectorMap
{};
