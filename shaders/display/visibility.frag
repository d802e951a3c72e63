#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { VisibilityPush push; };
layout(location = 0) flat in uint number;  // 1 + the display triangle
layout(location = 0) out uint seen;

void main() {
  seen = number;
}
