// Volumes carried by a map of the whole inside of a body: its tets are laid into the source's domain harmonically, that
// is with every vertex below the surface at the mean of those around it, as the elements weigh them.
#pragma once

#include "engine/scene/mapped_volume.h"
#include "engine/scene/source_domain.h"

namespace quadgraph {

// Throws InputError for a body without tets, or one whose surface is no ball's where the source's is.
MappedVolume harmonically_mapped(const SourceDomain& source, const BodySurface& body);

}  // namespace quadgraph
