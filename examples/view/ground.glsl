// The viewer's ground: lines in a plane, ten of them to each strong one, fading towards the border.
// ../host_shaders.sh puts this text and its SPIR-V into ground_shaders.h.
#ifdef VULKAN
#define NUMBER gl_VertexIndex
#define LINK layout(location = 0)
layout(push_constant) uniform
#else
#define NUMBER gl_VertexID
#define LINK
uniform struct
#endif
Ground {
    mat4 clip;
    vec4 middle, right, up, color; // middle.w: distance of the lines; right.w: half the size; mm
} ground;

#ifdef VERTEX
LINK out vec2 place; // mm from the middle
void main() {
    place = (vec2(NUMBER & 1, NUMBER >> 1) * 2.0 - 1.0) * ground.right.w;
    vec3 at = ground.middle.xyz + ground.right.xyz * place.x + ground.up.xyz * place.y;
    gl_Position = ground.clip * vec4(at, 1.0);
}
#else
LINK in vec2 place;
layout(location = 0) out vec4 color;
// How much of the pixel a line covers; where lines come closer than pixels, their mean.
float lines(float spacing) {
    vec2 at = place / spacing, step = fwidth(at);
    vec2 covered = 1.0 - min(abs(fract(at - 0.5) - 0.5) / step, 1.0);
    return mix(max(covered.x, covered.y), 0.0, min(max(step.x, step.y), 1.0));
}
void main() {
    float fade = clamp(1.6 - 1.6 * length(place) / ground.right.w, 0.0, 1.0);
    float all = max(0.35 * lines(ground.middle.w), lines(10.0 * ground.middle.w));
    color = vec4(ground.color.xyz, ground.color.w * fade * all);
}
#endif
