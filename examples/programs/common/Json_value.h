// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// A value of a JSON file with its JSON pointer, so that every error names the position in the file.

#ifndef PCS_EXAMPLES_PROGRAMS_COMMON_JSON_VALUE_H
#define PCS_EXAMPLES_PROGRAMS_COMMON_JSON_VALUE_H

#include <pcs/core/errors.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace program {

using Json = nlohmann::json;

class Json_value
{
public:
  Json_value(const Json& value, const std::string& file, std::string pointer = "")
    : m_value(&value), m_file(&file), m_pointer(std::move(pointer))
  {
  }

  const Json& json() const { return *m_value; }
  const std::string& pointer() const { return m_pointer; }
  bool has(const char* key) const { return m_value->contains(key); }
  std::size_t size() const { return m_value->size(); }

  Json_value operator[](const char* key) const
  {
    return {m_value->at(key), *m_file, m_pointer + "/" + key};
  }
  Json_value operator[](std::size_t i) const
  {
    return {m_value->at(i), *m_file, m_pointer + "/" + std::to_string(i)};
  }

  /// Throws an error about this value.
  [[noreturn]] void fail(const std::string& what) const
  {
    throw pcs::IO_error(*m_file, (m_pointer.empty() ? "top level" : m_pointer) + ": " + what);
  }
  [[noreturn]] void fail_expected(const std::string& expected) const
  {
    fail("expected " + expected + ", found " + description());
  }

  /// Checks that this is an object without other keys.
  const Json_value& object(std::initializer_list<const char*> keys) const
  {
    std::string list;
    for (const char* key : keys)
      list += std::string(list.empty() ? "" : ", ") + key;
    if (!m_value->is_object())
      fail_expected("an object with " + list);
    for (const auto& item : m_value->items()) {
      bool is_known = false;
      for (const char* key : keys)
        is_known = is_known || item.key() == key;
      if (!is_known)
        fail("unknown key " + shown(item.key()) + ", expected " + list);
    }
    return *this;
  }

  const Json_value& array(std::size_t size, const std::string& expected) const
  {
    if (!m_value->is_array() || m_value->size() != size)
      fail_expected(expected);
    return *this;
  }

  double number(const std::string& expected = "a number") const
  {
    if (!m_value->is_number())
      fail_expected(expected);
    return m_value->get<double>(); // finite: the parser rejects numbers that overflow
  }

  Eigen::Vector3d vector_3() const
  {
    array(3, "[x, y, z]");
    const Json_value& v = *this;
    return {v[std::size_t(0)].number(), v[std::size_t(1)].number(), v[std::size_t(2)].number()};
  }

private:
  static std::string shown(const Json& scalar)
  {
    std::string text = scalar.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (text.size() > 60)
      text = text.substr(0, 60) + "...";
    return text;
  }

  /// Describes the value without its contents, which may be large or deeply nested.
  std::string description() const
  {
    if (m_value->is_object())
      return "an object";
    if (m_value->is_array())
      return "an array of length " + std::to_string(m_value->size());
    return shown(*m_value);
  }

  const Json* m_value;
  const std::string* m_file;
  std::string m_pointer;
};

/// Parses a file. Throws `pcs::IO_error` if the file is not JSON, or an object repeats a key.
/// `expected`: what the file should hold.
inline Json read_json(const std::string& path, const std::string& expected)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw pcs::IO_error(path, "cannot be opened for reading");
  std::ostringstream content;
  content << in.rdbuf(); // unlike iterators, does not throw for a folder
  const std::string text = content.str();
  if (text.empty())
    throw pcs::IO_error(path, "is empty or cannot be read, expected " + expected + " in JSON");

  std::vector<std::set<std::string>> keys; // keys of the open objects
  const auto refuse_duplicates = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start)
      keys.emplace_back();
    else if (event == Json::parse_event_t::object_end)
      keys.pop_back();
    else if (event == Json::parse_event_t::key &&
             !keys.back().insert(value.get<std::string>()).second)
      throw pcs::IO_error(path,
                          "the key \"" + value.get<std::string>() + "\" occurs twice in an object");
    return true;
  };
  try {
    return Json::parse(text, refuse_duplicates);
  } catch (const Json::exception& e) {
    const std::string what = e.what(); // "[json.exception.parse_error.101] parse error at line ..."
    throw pcs::IO_error(path, "not valid JSON: " + what.substr(what.find("] ") + 2));
  }
}

} // namespace program

#endif // PCS_EXAMPLES_PROGRAMS_COMMON_JSON_VALUE_H
