// Numbers in the texts that users write and that files keep.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadgraph {

// The parts of `text` between separators; one empty part for an empty text.
std::vector<std::string_view> split(std::string_view text, char separator);

// The finite number that `text` is from end to end. Throws InputError "`field`: found '...', expected a number".
double parse_number(std::string_view text, const std::string& field);

// Exactly three numbers joined by `separator`. Throws InputError.
glm::vec3 parse_triple(std::string_view text, char separator, const std::string& field);

// One number for all channels, or R/G/B. Throws InputError.
glm::vec3 parse_rgb(std::string_view text, const std::string& field);

// The shortest text that reads back as the same value.
std::string number_text(float value);
std::string number_text(double value);

// A share in per cent, with two digits.
std::string percent_text(double share);

// number_text of each, joined; `rgb_text` writes equal channels once.
std::string triple_text(const glm::vec3& value, char separator);
std::string rgb_text(const glm::vec3& value);

// The text that printf would print, at most 255 bytes.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace quadgraph
