#include "engine/scene/camera_options.h"

#include "engine/scene/option_forms.h"

namespace quadgraph {
namespace {

void add_camera(OptionTable& table) {
  table.group(camera_group);
  table.text(OptionKind::text,
             {.name = "view",
              .member = "/camera/azimuth",
              .keyword = "view",
              .own_form = true,
              .metavar = "A,E[,D]",
              .help = "azimuth and elevation in degrees, and distance in mm from the object's centre; without a "
                      "distance the object fits the picture. Default: elevation 10 from the front that the bake found "
                      "or --front gave"},
             view_of, set_view);
  table.member<&Scene::view, &View::azimuth>({.name = "azimuth",
                                              .member = "/camera/azimuth",
                                              .on_command_line = false,
                                              .help = "degrees; left out: the front of the body"});
  table.member<&Scene::view, &View::elevation>({.name = "elevation",
                                                .member = "/camera/elevation",
                                                .on_command_line = false,
                                                .range = elevation_range,
                                                .help = "degrees"});
  table.member<&Scene::view, &View::distance>(
      {.name = "distance",
       .member = "/camera/distance",
       .on_command_line = false,
       .range = distance_range,
       .help = "mm from the middle of what the picture shows; left out: the body fits the picture"});
}

void add_camera_places(OptionTable& table) {
  table.text(
      OptionKind::text,
      {.name = "eye",
       .member = "/camera/eye",
       .keyword = "eye",
       .own_form = true,
       .metavar = "X,Y,Z",
       .help =
           "where the camera is, mm in the coordinates of the body, in place of azimuth, elevation and distance; goes "
           "with --look-at"},
      eye_of, set_eye);
  table.text(OptionKind::text,
             {.name = "look-at",
              .member = "/camera/look_at",
              .keyword = "look_at",
              .own_form = true,
              .metavar = "X,Y,Z",
              .help = "what the middle of the picture shows, mm in the coordinates of the body; goes with --eye"},
             look_at_of, set_look_at);
}

void add_projection(OptionTable& table) {
  table.member<&Scene::view, &View::up>(
      {.name = "up", .member = "/camera/up", .keyword = "up", .help = "the axis that points up"});
  table.member<&Scene::view, &View::vertical_fov>({.name = "fov",
                                                   .member = "/camera/fov",
                                                   .keyword = "vertical_fov",
                                                   .metavar = "DEGREES",
                                                   .range = fov_range,
                                                   .help = "vertical field of view, degrees"});
  table.member<&Scene::view, &View::orthographic>(
      {.name = "orthographic",
       .member = "/camera/orthographic",
       .keyword = "orthographic",
       .metavar = "MM",
       .range = height_range,
       .help = "parallel rays, with which the height of the picture shows so many mm at any distance; 0: the object "
               "fits the picture; left out: perspective"});
  table.member<&Scene::view, &View::framing>({.name = "framing",
                                              .member = "/camera/framing",
                                              .keyword = "framing",
                                              .help = "what fits the picture where no distance is said"});
}

void add_lens(OptionTable& table) {
  table.member<&Scene::view, &View::aperture>(
      {.name = "aperture",
       .member = "/camera/aperture",
       .keyword = "aperture",
       .metavar = "MM",
       .range = aperture_range,
       .help = "diameter of the lens, mm: what is not at the distance of --focus is blurred; 0: all is sharp"});
  table.member<&Scene::view, &View::focus>(
      {.name = "focus",
       .member = "/camera/focus",
       .keyword = "focus",
       .metavar = "MM",
       .range = distance_range,
       .help = "distance from the eye to the plane that is sharp, mm along the view; left out: that of the nearest of "
               "the object in the middle of the picture"});
}
}  // namespace

void add_camera_options(OptionTable& table) {
  add_camera(table);
  add_camera_places(table);
  add_projection(table);
  add_lens(table);
}

}  // namespace quadgraph
