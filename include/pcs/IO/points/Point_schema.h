// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Properties of the points of a file, and the metadata required to write the file again.

#ifndef PCS_IO_POINTS_POINT_SCHEMA_H
#define PCS_IO_POINTS_POINT_SCHEMA_H

#include <pcs/IO/points/Scalar_type.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pcs {
namespace IO {

/*!
  \ingroup PkgPcsIORef
  \brief The families of point file formats that pcs reads; most are also written.
*/
enum class File_format : std::uint8_t {
  automatic, //!< reading: by content, then extension; writing: by extension
  ply,       //!< ascii, binary little endian, binary big endian
  text,      //!< one point per line: xyz, txt, csv, asc, pts, pwn
  off,       //!< OFF, NOFF, COFF, CNOFF
  las,       //!< LAS 1.0 to 1.4, and LAZ where LASzip is available
  pcd,       //!< ascii, binary, binary_compressed; reading only
  ptx,       //!< one or several scans with their poses; reading only
  obj,       //!< the vertices and faces
  glb        //!< triangles or points as binary glTF 2.0; writing only
};

/*!
  \ingroup PkgPcsIORef
  \brief The parts of a LAS file around the point records, stored unchanged.

  Counts, bounding box and positions inside `header` are updated when the file is written.
*/
struct Las_metadata
{
  std::vector<unsigned char> header; //!< public header block
  std::vector<unsigned char> vlrs;   //!< data between the header and the first point record
  std::vector<unsigned char> tail;   //!< data after the last point record (EVLRs, waveforms)
  std::uint64_t tail_position = 0;   //!< position of `tail` in the file [byte]
  std::array<double, 3> scale{};     //!< length of one step of the stored integers [L]
  std::array<double, 3> offset{};    //!< coordinate of the integer 0 [L]
};

/*!
  \ingroup PkgPcsIORef
  \brief Name and type of one property.
*/
struct Property_description
{
  std::string name;
  Scalar_type type = Scalar_type::float64;

  friend bool operator==(const Property_description& a, const Property_description& b)
  {
    return a.name == b.name && a.type == b.type;
  }
  friend bool operator!=(const Property_description& a, const Property_description& b)
  {
    return !(a == b);
  }
};

/*!
  \ingroup PkgPcsIORef
  \brief The properties of a point file in file order, and the data specific to its format.
*/
struct Point_schema
{
  //! all properties in file order; `x`, `y` and `z` are among them
  std::vector<Property_description> properties = {{"x", Scalar_type::float64},
                                                  {"y", Scalar_type::float64},
                                                  {"z", Scalar_type::float64}};
  File_format format = File_format::automatic; //!< format of the file that was read
  std::vector<std::string> comments;           //!< PLY comment lines, without the keyword
  std::vector<std::string> obj_info;           //!< PLY obj_info lines, without the keyword
  std::shared_ptr<const Las_metadata> las;     //!< null unless read from a LAS file
  std::vector<std::string>
      warnings; //!< sentences on what of the file was not read as it is written

  //! returns the index of a property in `properties`, or `properties.size()`
  std::size_t find(const std::string& name) const
  {
    std::size_t i = 0;
    while (i < properties.size() && properties[i].name != name)
      ++i;
    return i;
  }
  //! whether there is a property of that name (true for `x`, `y`, `z`)
  bool has(const std::string& name) const { return find(name) < properties.size(); }
};

//! whether the name is one of `x`, `y`, `z`
inline bool is_coordinate_name(const std::string& name)
{
  return name.size() == 1 && name[0] >= 'x' && name[0] <= 'z';
}

} // namespace IO
} // namespace pcs

#endif // PCS_IO_POINTS_POINT_SCHEMA_H
