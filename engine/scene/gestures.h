// What dragging and turning do to a camera and to a light.
#pragma once

#include <glm/vec2.hpp>

#include "engine/deform/cut.h"
#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"

namespace quadgraph {

// What moves a view makes of one by places the same by angles, and keeps of one that fits the picture what it has.

// The object turns with the hand: the eye goes `right` and `up` degrees the other way round it.
View orbited(const View& view, const Sphere& bounds, float aspect, float right, float up);

// The object moves right and up by shares of the picture's height.
View panned(const View& view, const Sphere& bounds, float aspect, float right, float up);

// The eye comes nearer by so many steps, an eighth of its distance each; an orthographic picture shows so much less.
View zoomed(const View& view, const Sphere& bounds, float aspect, float steps);

// Where the light comes from goes right and up round the object's centre, degrees as the viewer sees it.
Light turned(Light light, const View& view, const Sphere& bounds, float right, float up);

// A light of another kind, not a projector, that lights the object's centre about as strongly and from the same side.
Light as_kind(const Light& light, LightKind kind, const Sphere& bounds);

// A rectangular light turned to shine along a unit direction that is not vertical, with two of its edges horizontal.
Light faced(Light rectangle, const glm::vec3& direction, UpAxis up);

// The plane through a stroke over the picture, along what looks there, between two points in clip coordinates (right
// and up, -1 to 1) that are not the same. What lies to the right of the hand's way goes.
BodyCut cut_along(const View& view, const Sphere& bounds, float aspect, const glm::vec2& from, const glm::vec2& to);

// Where a light comes from, as azimuth and elevation of a View, degrees; and the unit vector towards there.
struct Bearing {
  float azimuth = 0, elevation = 0;
};
Bearing bearing_of(const glm::vec3& towards, UpAxis up);
glm::vec3 towards(const Bearing& bearing, UpAxis up);

}  // namespace quadgraph
