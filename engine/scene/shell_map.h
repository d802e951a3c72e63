// Volumes carried by the place on the surface and the depth below it [Porumbescu 2005], what lies deeper than the
// source's own surface layer interpolated.
//
// Of a block: the surface of the body is projected along x, y and z onto the faces of the block that look the same way,
// mm for mm; between two projections both are mixed. Of another body: a place goes to the place of the source that is
// nearest once their boxes are the same, and from there as far inwards.
#pragma once

#include "engine/scene/mapped_volume.h"
#include "engine/scene/source_domain.h"

namespace quadgraph {

// Throws InputError.
MappedVolume shell_mapped(const SourceDomain& source, const MaterialMap& map, const BodySurface& body);

}  // namespace quadgraph
