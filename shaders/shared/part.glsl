// What a dispatch that reduces does (reduce.glsl): all of it; or only the workgroups' sums; or, in a dispatch of one
// workgroup that follows, the rest. llvmpipe walks through what the last workgroup alone has to do in every one.
#ifndef QUADGRAPH_PART_GLSL
#define QUADGRAPH_PART_GLSL

const uint PART_WHOLE = 0u;
const uint PART_SUMS = 1u;
const uint PART_CONCLUSION = 2u;
layout(constant_id = 6) const uint PART = PART_WHOLE;

#endif
