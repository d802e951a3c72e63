// What a picture shows: the body as it looks, or what is inside the computation, as false colour.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/names.h"
#include "engine/base/solve_options.h"
#include "engine/optics/certainty.h"

namespace quadgraph {

enum class Quantity {
  picture,                   // the body as it looks
  q,                         // light that enters: irradiance of the outside faces
  exitance,                  // light that leaves, scattered and not
  error,                     // estimated error of the exitance
  difference,                // exitance by another method, less ours
  levels,                    // outside faces of a level, by the length of their edges
  phi,                       // fluence on a cutting plane
  tets,                      // the tets of a level on a cutting plane, by the length of their edges
  links,                     // nodes and links of the QuadGraph at a cutting plane
  sigma_s_prime_deviation,   // how certain sigma_s' is on a cutting plane
  sigma_a_deviation,         // the same of sigma_a
  sigma_s_prime_resolution,  // over which length sigma_s' is one number, on a cutting plane
  sigma_a_resolution,        // the same of sigma_a
};

template <>
struct Names<Quantity> {
  static constexpr std::string_view what = "show";
  static constexpr auto values = std::to_array<Named<Quantity>>(
      {{Quantity::picture, "picture", "the body as it looks"},
       {Quantity::q, "q", "irradiance that enters"},
       {Quantity::exitance, "exitance", "light that leaves"},
       {Quantity::error, "error", "estimated error of the exitance"},
       {Quantity::difference, "difference", "exitance by another method, less ours"},
       {Quantity::levels, "levels", "outside faces of a level, by their edges"},
       {Quantity::phi, "phi", "fluence on a cutting plane"},
       {Quantity::tets, "tets", "the tets of a level on a cutting plane"},
       {Quantity::links, "links", "nodes and links of the QuadGraph at a cutting plane"},
       {Quantity::sigma_s_prime_deviation, "sigma_s_prime_deviation",
        "standard deviation of sigma_s' on a cutting plane"},
       {Quantity::sigma_a_deviation, "sigma_a_deviation", "standard deviation of sigma_a on a cutting plane"},
       {Quantity::sigma_s_prime_resolution, "sigma_s_prime_resolution",
        "resolution length of sigma_s' on a cutting plane"},
       {Quantity::sigma_a_resolution, "sigma_a_resolution", "resolution length of sigma_a on a cutting plane"}});
};

struct Show {
  Quantity quantity = Quantity::picture;
  int axis = 2;                          // 0 x, 1 y, 2 z: across the cutting plane
  float offset = 0;                      // mm along it, of the plane from the object's centre
  std::uint32_t level = 0;               // levels, tets, links: of this level, 0 the finest
  Method other = Method::quadgraph_fdm;  // difference: this method

  bool operator==(const Show&) const = default;
};

bool has_plane(Quantity quantity);
// What of the coefficients' certainty it shows, if it does.
std::optional<Knowledge> knowledge_of(Quantity quantity);
bool has_level(Quantity quantity);

// All that parse_show reads, for help and errors.
extern const char* const show_forms;

// "NAME", with a plane "NAME:AXIS" or "NAME:AXIS,MM", with a level "levels:N", "tets:z,0,N", "difference:METHOD".
// Throws InputError that lists what is allowed.
Show parse_show(std::string_view text);

// What parse_show reads back as the same.
std::string to_string(const Show& show);

// What the colours mean.
struct Legend {
  std::string title, unit;
  double low = 0, high = 1;  // in the unit, at the ends of the bar
  bool logarithmic = false, diverging = false;

  // The place of a value along the bar, 0 to 1 inside it.
  float place(double value) const;
  double value_at(double place) const;
};

}  // namespace quadgraph
