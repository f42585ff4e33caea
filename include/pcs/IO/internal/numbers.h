// Copyright (c) 2026 The pcs authors
// SPDX-License-Identifier: BSL-1.0
// Locale-independent conversion of numbers to and from text and bytes; words of a line.

#ifndef PCS_IO_INTERNAL_NUMBERS_H
#define PCS_IO_INTERNAL_NUMBERS_H

#include <pcs/IO/points/Scalar_type.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace pcs {
namespace IO {
namespace internal {

enum class Parse_result { ok, not_a_number, out_of_range };

inline bool is_blank(char c)
{
  return c == ' ' || c == '\t';
}

//! removes blanks at both ends
inline std::string_view trim(std::string_view text)
{
  while (!text.empty() && is_blank(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  return text;
}

//! removes the next word from a line and returns it; empty if there is none
inline std::string_view next_word(std::string_view& line)
{
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin]))
    ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end]))
    ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

//! removes a plus sign, which is valid in files but not accepted by std::from_chars
inline std::string_view without_plus(std::string_view word)
{
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+')
    word.remove_prefix(1);
  return word;
}

template <class T>
Parse_result parse_plain(std::string_view word, T& value)
{
  const char* last = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), last, value);
  if (result.ec == std::errc::invalid_argument || result.ptr != last)
    return Parse_result::not_a_number;
  return result.ec == std::errc() ? Parse_result::ok : Parse_result::out_of_range;
}

//! converts a complete word to a `T`; an integer may be written as 12.0 or 1e3 but not as 1.5
template <class T>
Parse_result parse_number(std::string_view word, T& value)
{
  word = without_plus(word);
  const Parse_result result = parse_plain(word, value);
  if (result == Parse_result::ok || std::is_same_v<T, double>)
    return result;
  double wide = 0;
  const Parse_result wide_result = parse_plain(word, wide);
  if (wide_result != Parse_result::ok)
    return wide_result;
  if constexpr (std::is_same_v<T, float>) {
    // values too small for a float are rounded to zero; too large values are refused
    if (std::abs(wide) > 1)
      return Parse_result::out_of_range;
    value = static_cast<float>(wide);
    return Parse_result::ok;
  } else {
    // double represents both bounds exactly, even those of 64-bit integers
    const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(wide >= static_cast<double>(std::numeric_limits<T>::min()) && wide < end))
      return Parse_result::out_of_range;
    if (wide != std::floor(wide))
      return Parse_result::not_a_number;
    value = static_cast<T>(wide);
    return Parse_result::ok;
  }
}

//! parses a word as `type` and stores the value in native byte order
inline Parse_result parse_to_bytes(std::string_view word, Scalar_type type, unsigned char* to)
{
  return dispatch(type, [&](auto tag) {
    typename decltype(tag)::type value{};
    const Parse_result result = parse_number(word, value);
    std::memcpy(to, &value, sizeof value);
    return result;
  });
}

//! appends a number with the fewest digits that preserve its value
template <class T>
void append_number(std::string& text, T value)
{
  std::array<char, 32> digits; // a double needs at most 24
  const std::to_chars_result result =
      std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), result.ptr);
}

//! quotes a word for a message, shortened to 40 characters
inline std::string in_quotes(std::string_view word)
{
  std::string text = "'";
  for (const char c : word.substr(0, 40))
    text += (c >= ' ' && c <= '~') ? c : '?';
  return text + (word.size() > 40 ? "...'" : "'");
}

inline bool is_big_endian_machine()
{
  const std::uint16_t one = 1;
  unsigned char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 0;
}

//! reads a `T` from bytes, in reverse byte order if `do_swap`
template <class T>
T load(const unsigned char* from, bool do_swap)
{
  T value;
  if (do_swap) {
    std::array<unsigned char, sizeof(T)> swapped;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      swapped[i] = from[sizeof(T) - 1 - i];
    std::memcpy(&value, swapped.data(), sizeof(T));
  } else {
    std::memcpy(&value, from, sizeof(T));
  }
  return value;
}

//! writes a `T` to bytes, in reverse byte order if `do_swap`
template <class T>
void store(T value, unsigned char* to, bool do_swap)
{
  std::memcpy(to, &value, sizeof(T));
  if (do_swap)
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i)
      std::swap(to[i], to[sizeof(T) - 1 - i]);
}

//! reads a little endian `T` at a byte position of a block
template <class T, class Bytes>
T load_little(const Bytes& bytes, std::size_t at)
{
  return load<T>(bytes.data() + at, is_big_endian_machine());
}

//! writes a little endian `T` at a byte position of a block
template <class T, class Bytes>
void store_little(Bytes& bytes, std::size_t at, T value)
{
  store<T>(value, bytes.data() + at, is_big_endian_machine());
}

} // namespace internal
} // namespace IO
} // namespace pcs

#endif // PCS_IO_INTERNAL_NUMBERS_H
