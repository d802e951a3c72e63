// Buffer references: arrays reached through the addresses in push constants, in scalar layout.
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
