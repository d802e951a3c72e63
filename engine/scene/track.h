// A value of a scene file that changes from frame to frame.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "engine/scene/json_field.h"

namespace quadgraph {

// Puts `value` where `pointer` (RFC 6901) leads to: in place of what is there, or as a new member of an object, whose
// own parents are made if need be. Throws InputError, and changes nothing, if it leads nowhere.
void put(Json& document, const std::string& pointer, const Json& value);

enum class Between { linear, smooth, step };

template <>
struct Names<Between> {
  static constexpr std::string_view what = "between";
  static constexpr auto values =
      std::to_array<Named<Between>>({{Between::linear, "linear", "linearly from key to key"},
                                     {Between::smooth, "smooth", "starting and ending slowly at every key"},
                                     {Between::step, "step", "the value of the key before"}});
};

class Track {
 public:
  // {"path": "/camera/azimuth", "keys": [[FRAME, VALUE], ...], "between": "linear"}: frames strictly ascending; values
  // all numbers, or all arrays of as many numbers, or, with "step", anything. "between" is "linear" (also without it),
  // "smooth" (starting and ending slowly at every key) or "step". Throws InputError with the path of what is wrong.
  explicit Track(const JsonField& field);

  // Puts the value of a frame into `document`; before the first key it is that of the first, after the last that of the
  // last. Throws InputError as `put`.
  void apply(double frame, Json& document) const;

  // The value of a frame, and the pointer to where it belongs.
  Json at(double frame) const;
  const std::string& target() const { return target_; }

  const std::vector<std::pair<double, Json>>& keys() const { return keys_; }

 private:
  std::string where_;  // the track's own path
  std::string target_;
  Between between_ = Between::linear;
  std::vector<std::pair<double, Json>> keys_;
};

}  // namespace quadgraph
