// Buffer references: arrays reached through the addresses in push constants, in scalar layout.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

#define QG_ARRAY(Name, Type)                                                 \
  layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Name { \
    Type at[];                                                               \
  }
