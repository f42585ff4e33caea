// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// An editor: a session as a member of a class, with undo of motions and of handles.

#include "pillar.h"
#include <pcs/Point_set_deformation.h>

#include <CGAL/Simple_cartesian.h>

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <utility>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;

//! [editor]
class Editor
{
  using Points = std::vector<Kernel::Point_3>;
  using Session = pcs::Point_set_deformation<Points>; // options are no part of the type

public:
  explicit Editor(Points points)
    : m_points(std::move(points)), m_session(m_points, pcs::parameters::number_of_samples(500))
  {
    keep_state();
  }
  Editor(const Editor&) = delete; // the session refers to the points
  Editor& operator=(const Editor&) = delete;

  std::size_t hold(const std::vector<std::size_t>& indices)
  {
    const std::size_t handle = m_session.add_handle(indices);
    keep_state();
    return handle;
  }
  void move(std::size_t handle, const pcs::Similarity& motion)
  {
    m_session.set_transformation(handle, motion);
    keep_state();
  }
  void undo() // of a motion or of a new handle
  {
    if (m_states.size() > 1)
      m_states.pop_back();
    m_session.restore(m_states.back());
  }
  const Points& points() const { return m_points; }

private:
  void keep_state()
  {
    m_session.deform();
    m_states.push_back(m_session.snapshot());
  }

  Points m_points;
  Session m_session;
  std::vector<Session::Snapshot> m_states;
};
//! [editor]

int main()
{
  const std::vector<Kernel::Point_3> at_rest = make_pillar<Kernel::Point_3>(5000);
  std::vector<std::size_t> feet, head, middle;
  for (std::size_t i = 0; i < 500; ++i) {
    feet.push_back(i);
    head.push_back(at_rest.size() - 1 - i);
    middle.push_back(at_rest.size() / 2 + i);
  }

  Editor editor(at_rest);
  editor.hold(feet);
  editor.move(editor.hold(head), pcs::rotation(Kernel::Vector_3(0, 1, 0), 1, at_rest[2500]));
  const std::vector<Kernel::Point_3> bent = editor.points();
  editor.move(editor.hold(middle), pcs::translation(Kernel::Vector_3(2, 0, 0)));
  editor.undo(); // of the motion of the middle
  editor.undo(); // of its handle
  const bool is_bent = editor.points() == bent;
  for (int i = 0; i < 3; ++i)
    editor.undo();
  const bool is_at_rest = editor.points() == at_rest;

  std::cout << "bent again: " << is_bent << ", at rest again: " << is_at_rest << '\n';
  return is_bent && is_at_rest ? EXIT_SUCCESS : EXIT_FAILURE;
}
