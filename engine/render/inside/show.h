// What a picture shows: the body as it looks, or what is inside the computation, as false colour.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/solve_options.h"

namespace quadgraph {

enum class Quantity {
  picture,     // the body as it looks
  q,           // light that enters: irradiance of the outside faces
  exitance,    // light that leaves, scattered and not
  error,       // estimated error of the exitance
  difference,  // exitance by another method, less ours
  levels,      // outside faces of a level, by the length of their edges
  phi,         // fluence on a cutting plane
  tets,        // the tets of a level on a cutting plane, by the length of their edges
  links,       // nodes and links of the QuadGraph at a cutting plane
};

// All, in the order in which they are offered; "picture", "q", "exitance", ...
inline constexpr Quantity quantities[] = {Quantity::picture, Quantity::q,          Quantity::exitance,
                                          Quantity::error,   Quantity::difference, Quantity::levels,
                                          Quantity::phi,     Quantity::tets,       Quantity::links};
std::string_view name_of(Quantity quantity);

struct Show {
  Quantity quantity = Quantity::picture;
  int axis = 2;                          // 0 x, 1 y, 2 z: across the cutting plane
  float offset = 0;                      // mm along it, of the plane from the object's centre
  std::uint32_t level = 0;               // levels, tets, links: of this level, 0 the finest
  Method other = Method::quadgraph_fdm;  // difference: this method

  bool operator==(const Show&) const = default;
};

bool has_plane(Quantity quantity);
bool has_level(Quantity quantity);

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
