// The host's own shader of host_depth.c: a box out of the vertex number, without buffers.
// host_shaders.sh puts this text and its SPIR-V into host_depth_shaders.h.
#ifdef VULKAN
#define NUMBER gl_VertexIndex
#define LINK layout(location = 0) flat
layout(push_constant) uniform
#else
#define NUMBER gl_VertexID
#define LINK flat
uniform struct
#endif
Box {
    mat4 clip;
    vec4 lower, upper, color;
} box;

#ifdef VERTEX
LINK out vec4 shaded;
void main() {
    int face = NUMBER / 6, corner = NUMBER % 6, axis = face / 2;
    corner = corner < 3 ? corner : 6 - corner; // two triangles: 0 1 2 and 3 2 1
    vec3 at = vec3(face % 2, corner % 2, corner / 2);
    at = axis == 0 ? at.xyz : axis == 1 ? at.zxy : at.yzx;
    gl_Position = box.clip * vec4(mix(box.lower.xyz, box.upper.xyz, at), 1.0);
    shaded = box.color * (axis == 1 ? 1.0 : axis == 0 ? 0.6 : 0.8);
}
#else
LINK in vec4 shaded;
layout(location = 0) out vec4 color;
void main() { color = vec4(shaded.xyz, 1.0); }
#endif
