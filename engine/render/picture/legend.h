// The colour bar of a view of the inside.
#pragma once

#include <string>
#include <vector>

#include "engine/render/inside/show.h"
#include "engine/render/picture/picture.h"

namespace quadgraph {

// Round values along the bar, its ends among them where they are round enough, in the shortest text that tells them
// apart.
struct Tick {
  float place;  // 0 to 1
  std::string text;
};
std::vector<Tick> ticks_of(const Legend& legend);

// Draws bar, title, unit and ticks along the lower edge of a false colour picture. Pictures too small for it stay as
// they are.
void draw_legend(Picture& picture, const Legend& legend);

}  // namespace quadgraph
