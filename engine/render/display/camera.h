// Where the picture is taken from.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/names.h"
#include "engine/base/range.h"

namespace quadgraph {

struct Sphere {
  glm::vec3 centre{0};  // mm
  float radius = 0;     // mm
};

// The sphere around the middle of the bounding box that holds every point.
Sphere bounding_sphere(std::span<const glm::vec3> points);

enum class UpAxis { y, z };

template <>
struct Names<UpAxis> {
  static constexpr std::string_view what = "up";
  static constexpr auto values =
      std::to_array<Named<UpAxis>>({{UpAxis::y, "y", "azimuth 0 looks along -z, 90 along -x"},
                                    {UpAxis::z, "z", "azimuth 0 looks along +y, 90 along -x"}});
};

inline constexpr Range elevation_range{.low = -90, .high = 90}, fov_range{.low = 1, .high = 150};  // degrees
inline constexpr Range distance_range{.low = 0, .above = true};                                    // mm

// A view of the object's centre, or of a point beside it. With y up, azimuth 0 looks along -z (from +z), azimuth 90
// looks along -x (from +x). With z up, azimuth 0 looks along +y (from -y), azimuth 90 along -x. Positive elevation
// looks from above.
struct View {
  float azimuth = 0;                // degrees
  float elevation = 10;             // degrees, in elevation_range
  std::optional<float> distance{};  // mm from the centre; without it the bounding sphere fits the picture
  UpAxis up = UpAxis::y;
  float vertical_fov = 30;  // degrees, in fov_range
  glm::vec3 target{0};      // mm from the object's centre: what the middle of the picture shows

  bool operator==(const View&) const = default;
};

// Where a body whose front is at that azimuth (about y) is seen from when nobody says so.
View first_view(float front, UpAxis up);

// Throws InputError if an angle or the distance is out of range.
void check_view(const View& view);

// Parses "azimuth,elevation" or "azimuth,elevation,distance" into a view with the given rest. Throws InputError.
View parse_view(std::string_view text, View rest = {});

// The text that parse_view reads, with the distance if there is one.
std::string to_string(const View& view);

// A perspective camera; axes are unit, right-handed, and `backward` points from the target to the eye.
struct Camera {
  glm::vec3 eye{0};  // mm
  glm::vec3 right{1, 0, 0};
  glm::vec3 up{0, 1, 0};
  glm::vec3 backward{0, 0, 1};
  glm::mat4 clip_from_world{1};  // depth 0 to 1, y up
};

// Throws InputError as check_view. `aspect` is width / height.
Camera place_camera(const View& view, const Sphere& bounds, float aspect);

}  // namespace quadgraph
