// Buffer references: arrays reached through the addresses in push constants, in scalar layout.
#ifndef QUADGRAPH_BUFFERS_GLSL
#define QUADGRAPH_BUFFERS_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#define QG_ARRAY(Name, Type)                                                 \
  layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Name { \
    Type at[];                                                               \
  }
// Written by some invocations of a dispatch and read by others.
#define QG_COHERENT_ARRAY(Name, Type)                                                 \
  layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer Name { \
    Type at[];                                                                        \
  }
// At addresses that are a multiple of so many bytes.
#define QG_ALIGNED_ARRAY(Name, Type, bytes)                                      \
  layout(buffer_reference, scalar, buffer_reference_align = bytes) buffer Name { \
    Type at[];                                                                   \
  }
// With a value before the elements.
#define QG_HEADED_ARRAY(Name, Head, head, Type)                              \
  layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Name { \
    Head head;                                                               \
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

// a.at[i]; 1 everywhere if there is no array.
vec3 element_or_one(Vec3s a, uint i) {
  if (uvec2(a) == uvec2(0)) return vec3(1);
  return a.at[i];
}

float number_or_one(Floats a, uint i) {
  if (uvec2(a) == uvec2(0)) return 1.0;
  return a.at[i];
}

#endif
