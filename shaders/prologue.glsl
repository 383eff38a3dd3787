/* In front of every shader, behind the shared text of lineao.h: how a shader names what a row of the table gives it. */
#ifdef VULKAN
#define LAO_TEX(i, type, name) layout(set = 0, binding = 2 + i) uniform type name;
#define LAO_CONSTANT(i, name) layout(constant_id = i) const int name = 0;
#define LAO_VERTEX_INDEX uint(gl_VertexIndex)
#define LAO_LOCATED(i) layout(location = i)
layout(set = 0, binding = 0, std140) uniform lao_frame_block { lao_frame_uniforms lao_frame; };
#define LAO_SETTINGS_BLOCK(rows) layout(set = 0, binding = 1, std140) uniform lao_settings_block { vec4 lao_settings_rows[rows]; };
layout(push_constant, std140) uniform lao_step_block { lao_step_uniforms lao_step; };
#else
/* the constant itself stands in front, as text: see lao_shader.constants */
#define LAO_TEX(i, type, name) uniform type name;
#define LAO_CONSTANT(i, name)
#define LAO_VERTEX_INDEX uint(gl_VertexID)
#define LAO_LOCATED(i)
layout(std140) uniform lao_frame_block { lao_frame_uniforms lao_frame; };
#define LAO_SETTINGS_BLOCK(rows) layout(std140) uniform lao_settings_block { vec4 lao_settings_rows[rows]; };
layout(std140) uniform lao_step_block { lao_step_uniforms lao_step; };
#endif

#ifdef LAO_VERTEX
#define LAO_VARYING(i, type, name) LAO_LOCATED(i) out type name;
#define LAO_OUT(i, type, name)
/* Clip depth is [0, w]; the floor without clip control wants [-w, w]. */
void lao_emit(vec4 clip) {
#ifdef LAO_CLIP_NEGATIVE_ONE
    clip.z = 2.0 * clip.z - clip.w;
#endif
    gl_Position = clip;
}
#else
#define LAO_VARYING(i, type, name) LAO_LOCATED(i) in type name;
#define LAO_OUT(i, type, name) layout(location = i) out type name;
#define LAO_PIXEL ivec2(gl_FragCoord.xy)
#endif

/* One texel by integer coordinates given as floats; outside: the nearest inside. */
#define LAO_TEXEL(name, x, y, inverse_size) textureLod(name, vec2((x) + 0.5, (y) + 0.5) * (inverse_size), 0.0)
