// Buffer references: arrays reached through the addresses in push constants, in scalar layout.
#ifndef QUADGRAPH_BUFFERS_GLSL
#define QUADGRAPH_BUFFERS_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

#define QG_ARRAY(Name, Type)                                                 \
  layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Name { \
    Type at[];                                                               \
  }

// Scratch of a reduction over a whole dispatch; see reduce.glsl.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Reduction {
  uint ticket;  // workgroups done; zero between dispatches
  vec3 partials[];
};

QG_ARRAY(Floats, float);
QG_ARRAY(Uints, uint);
QG_ARRAY(Uvec2s, uvec2);
QG_ARRAY(Vec2s, vec2);
QG_ARRAY(Vec3s, vec3);
QG_ARRAY(Vec4s, vec4);
QG_ARRAY(Uvec3s, uvec3);
QG_ARRAY(Uvec4s, uvec4);
QG_ARRAY(RowUints, uint);
QG_ARRAY(RowFloats, float);
QG_ARRAY(AssemblyUints, uint);
QG_ARRAY(AssemblyUvec2s, uvec2);
QG_ARRAY(AssemblyFloats, float);
QG_ARRAY(AssemblyVec2s, vec2);

#endif
