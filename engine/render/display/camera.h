// Where the picture is taken from.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/names.h"
#include "engine/base/range.h"

namespace quadgraph {

struct Sphere {
  glm::vec3 centre{0};  // mm
  float radius = 0;     // mm
  // mm: the points, on whose outline pictures are framed; without them it is that of the sphere. Shared, for they may
  // be many.
  std::shared_ptr<const std::vector<glm::vec3>> outline{};
};

// The sphere around the middle of the bounding box that holds every point, without an outline.
Sphere bounding_sphere(std::span<const glm::vec3> points);

enum class UpAxis { y, z };

template <>
struct Names<UpAxis> {
  static constexpr std::string_view what = "up";
  static constexpr auto values =
      std::to_array<Named<UpAxis>>({{UpAxis::y, "y", "azimuth 0 looks along -z, 90 along -x"},
                                    {UpAxis::z, "z", "azimuth 0 looks along +y, 90 along -x"}});
};

// What fits the picture where nothing says how far the eye is.
enum class Framing { automatic, outline, turned };

template <>
struct Names<Framing> {
  static constexpr std::string_view what = "framing";
  static constexpr auto values = std::to_array<Named<Framing>>(
      {{Framing::automatic, "auto", "turned where the camera goes around, as of turntables, else outline"},
       {Framing::outline, "outline", "what the body covers in this picture"},
       {Framing::turned, "turned", "what it covers in any picture as it turns about the axis that points up"}});
};

inline constexpr Range elevation_range{.low = -90, .high = 90},
    fov_range{.low = 0, .high = 150, .above = true};                                     // degrees
inline constexpr Range distance_range{.low = 0, .above = true}, height_range{.low = 0};  // mm
inline constexpr Range aperture_range{.low = 0};                                         // mm

// A view of the object's centre, or of a point beside it. With y up, azimuth 0 looks along -z (from +z), azimuth 90
// looks along -x (from +x). With z up, azimuth 0 looks along +y (from -y), azimuth 90 along -x. Positive elevation
// looks from above. `eye` and `look_at`, which are there together, say the same by places: azimuth (but straight from
// above or below), elevation, distance and target do not count beside them.
struct View {
  float azimuth = 0;                // degrees
  float elevation = 10;             // degrees, in elevation_range
  std::optional<float> distance{};  // mm from the centre; without it the outline fits the picture
  UpAxis up = UpAxis::y;
  float vertical_fov = 30;  // degrees, in fov_range
  // mm: what the middle of the picture shows, from the object's centre, or from the middle of what fits.
  glm::vec3 target{0};
  // mm that the height of an orthographic picture shows, 0: the outline fits. Parallel rays, which come from
  // in front of the whole object however far the eye is; without it, perspective.
  std::optional<float> orthographic{};
  std::optional<glm::vec3> eye{}, look_at{};  // mm, as positions of lights are
  // mm, diameter of a thin lens; 0: a pinhole, with which all is sharp. Not of an orthographic camera.
  float aperture = 0;
  // mm from the eye along the view to the plane that is sharp; without it, that of the nearest of the object in the
  // middle of the picture, or of the target where nothing is.
  std::optional<float> focus{};
  Framing framing = Framing::automatic;  // where the outline is to fit

  bool operator==(const View&) const = default;
};

// Where a body whose front is at that azimuth (about y) is seen from when nobody says so.
View first_view(float front, UpAxis up);

// The same view by azimuth, elevation, distance and target.
View by_angles(const View& view, const Sphere& bounds);

// The same view by angles, with the distance (or the height of an orthographic picture) and the target that it has
// where it fits: it then stays as it is.
View framed(const View& view, const Sphere& bounds, float aspect);

// Throws InputError if a number is out of range, or if of `eye` and `look_at` one is missing or both are the same.
void check_view(const View& view);

// Parses "azimuth,elevation" or "azimuth,elevation,distance" into a view with the given rest. Throws InputError.
View parse_view(std::string_view text, View rest = {});

// The text that parse_view reads, with the distance if there is one; nothing of eye and look_at.
std::string to_string(const View& view);

// "x,y,z", mm, of a place. parse_place throws InputError naming `what`.
std::string place_text(const glm::vec3& place);
glm::vec3 parse_place(std::string_view text, const std::string& what);

// A view at its place. Axes are unit, right-handed, and `backward` points from the target to the eye.
struct Camera {
  bool parallel = false;  // orthographic
  glm::dvec3 target{0};   // mm, what the middle of the picture shows
  glm::dvec3 eye{0};      // mm; with parallel rays a place before the whole object
  double distance = 1;    // mm from the target to the eye
  glm::vec3 right{1, 0, 0};
  glm::vec3 up{0, 1, 0};
  glm::vec3 backward{0, 0, 1};
  double half_width = 1, half_height = 1;  // mm, of the picture on the plane through the target
  glm::vec3 ahead{0, 0, -1};               // from the eye to the target, 1 long along the view
  float reach = 1;                         // mm, more than the object is wide
  // From places to clip space, y up, depth 1 before the object and 0 behind it. In single precision, so that a picture
  // stays put however far the eye is, it applies to the difference from `origin` (mm), which is near what is seen.
  glm::mat4 clip_from_offset{1};
  glm::vec3 origin{0};

  glm::vec4 clip(const glm::vec3& place) const { return clip_from_offset * glm::vec4(place - origin, 1); }
  glm::vec4 seen_from() const;  // shaders/shared/eye.h
  // Of rays that are 1 long along the view: how far they go to the right and up at the picture's edges.
  glm::vec2 slopes() const;
};

// What one point of the picture shows, `at` from -1 to 1 from left to right and from bottom to top.
struct ViewRay {
  glm::dvec3 from;     // mm: the eye, or with parallel rays before the whole object
  glm::dvec3 through;  // mm, on the plane through the target
  glm::dvec3 along;    // unit
};
ViewRay view_ray(const Camera& camera, const glm::vec2& at);

// The camera with the picture moved by `shift`, right and up, 1 being its half width and height, and with the eye moved
// by `lens`, mm right and up, while the plane that is `focus` mm before it stays where it is in the picture. Not `lens`
// of parallel rays.
Camera moved(const Camera& camera, const glm::dvec2& shift, const glm::dvec2& lens, double focus);

// Throws InputError as check_view. `aspect` is width / height.
Camera place_camera(const View& view, const Sphere& bounds, float aspect);

}  // namespace quadgraph
