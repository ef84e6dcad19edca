#include "client-min/web/web_light.h"

#include <GLES3/gl3.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gpu.h"
#include "client-min/draw/view_shade.h"
#include "client-min/view_record.h"
#include "client-min/web/web_program.h"

#define PLANT_TEXELS 3

/* What view_light.glsl is written in; places on the ground are metres from the eye. */
static const char language[] = "#define LIGHT\n"
	"#define real float\n"
	"#define ground_place vec2\n"
	"vec3 add(vec3 a, vec3 b) { return a + b; }\n"
	"vec3 scale(vec3 a, float t) { return a * t; }\n"
	"vec3 times(vec3 a, vec3 b) { return a * b; }\n"
	"vec3 blend(vec3 a, vec3 b, float t) { return mix(a, b, t); }\n"
	"vec3 unit(vec3 a) { return a / max(length(a), 1e-20); }\n"
	"float noise_at(vec2 at, int which);\n";

static const char light_text[] =
#include "view_light_text.h"
	;

static const char pixels[] =
	"uniform sampler2D u_shade;\n"
	"uniform highp usampler2D u_seen, u_plants;\n"
	"uniform sunlight u_sun;\n"
	"uniform float u_haze_m;\n"
	"uniform vec3 u_right, u_up, u_forward;  // the image plane's half extents, and its middle\n"
	"uniform bool u_by_kind, u_unshaded;\n"
	"uniform vec3 u_moved;           // from where feet are told to the eye\n"
	"uniform int u_shift;            // of plants\n"
	"uniform vec3 u_square;          // of u_shade: its corner from the eye, 1 / its side\n"
	/* cell of the eye, where in it, and how much a metre east and north is */
	"uniform ivec2 u_cell[OCTAVES];\n"
	"uniform vec2 u_part[OCTAVES];\n"
	"uniform vec4 u_metre[OCTAVES];\n"
	"out vec4 o_color;\n"
	WEB_IS_SUMMARY
	"float noise_at(vec2 at, int which) {\n"
	"	vec2 p = u_part[which] + u_metre[which].xy * at.x + u_metre[which].zw * at.y;\n"
	"	vec2 cell = floor(p);\n"
	"	uvec2 whole = uvec2(u_cell[which] + ivec2(cell));\n"
	"	return noise_in(whole.x, whole.y, p.x - cell.x, p.y - cell.y);\n"
	"}\n"
	"vec4 plant_texel(uint i) {\n"
	"	ivec2 at = ivec2(int(i) & ((1 << u_shift) - 1), int(i) >> u_shift);\n"
	"	return uintBitsToFloat(texelFetch(u_plants, at, 0));\n"
	"}\n"
	"vec3 light_of_bytes(vec3 c) {\n"
	"	return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));\n"
	"}\n"
	"vec3 bytes_of_light(vec3 c) {\n"
	"	return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));\n"
	"}\n"
	"vec3 plant_color(uvec4 seen, vec3 to) {\n"
	"	vec3 own = light_of_bytes(vec3(uvec3(seen.w, seen.w >> 8, seen.w >> 16) & 255u) / 255.0);\n"
	"	plant p = plant(0.0, 0.0, 0.0, 0.0, 0.0, summary_tone(seen.x >> 2));\n"
	"	vec3 local = vec3(0.0), to_eye = -unit(to);\n"
	"	if (!is_summary(seen)) {\n"
	"		uint at = (seen.x - 1u) * 3u;\n"
	"		vec4 a = plant_texel(at), foot = plant_texel(at + 1u), b = plant_texel(at + 2u);\n"
	"		p = plant(a.x, a.y, a.z, a.w, b.x, b.y);\n"
	"		vec3 d = (to + u_moved - foot.xyz) / foot.w;\n"
	"		local = vec3(d.x * p.cosine + d.y * p.sine, d.y * p.cosine - d.x * p.sine, d.z);\n"
	"	}\n"
	"	face look = face_of(u_sun, p, seen.y, to_eye);\n"
	"	crown around = crown_of(u_sun, p, local, to_eye, look.reach);\n"
	"	if (u_unshaded) around = crown_alone(u_sun, to_eye);\n"
	"	vec3 color = plant_light(u_sun, p, own, look.sun, around, u_by_kind);\n"
	"	return u_by_kind ? color : haze(u_sun, color, to, length(to), u_haze_m);\n"
	"}\n"
	"vec3 ground_pixel(uint surface, vec3 to) {\n"
	"	vec3 n = direction_of(surface);\n"
	"	vec2 at = (to.xy - u_square.xy) * u_square.z, taken = vec2(0.0);\n"
	"	if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))))\n"
	"		taken = textureLod(u_shade, at, 0.0).rg;\n"
	"	vec3 lit = ground_light(u_sun, n, taken.x, taken.y);\n"
	"	lit *= ground_albedo(to.xy, n.z, length(to));\n"
	"	return ground_color(u_sun, lit, to, u_haze_m, u_by_kind);\n"
	"}\n"
	"void main() {\n"
	"	uvec4 seen = texelFetch(u_seen, ivec2(gl_FragCoord.xy), 0);\n"
	"	vec2 at = gl_FragCoord.xy / vec2(textureSize(u_seen, 0)) * 2.0 - 1.0;\n"
	"	vec3 ray = u_right * at.x - u_up * at.y + u_forward, color;\n"
	"	float nearness = uintBitsToFloat(seen.z);\n"
	"	if (nearness == 0.0)\n"
	"		color = sky_color(u_sun, ray, u_by_kind);\n"
	"	else if (seen.x == 0u && !is_summary(seen))\n"
	"		color = ground_pixel(seen.y, ray / nearness);\n"
	"	else\n"
	"		color = plant_color(seen, ray / nearness);\n"
	"	o_color = vec4(bytes_of_light(vec3(shown(color.x), shown(color.y), shown(color.z))), 1.0);\n"
	"}\n";

#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value

/* ---- Life ---- */

enum eco_code web_light_prepare(struct web_light *light, struct eco_error *error)
{
	if (light->program)
		return ECO_OK;
	light->program = web_program((const char *const[]){ "#define OCTAVES " TEXT(VIEW_OCTAVES) "\n",
		language, light_text, pixels }, 4, "light", error);
	if (!light->program)
		return error->code;
	view_gpu_init(&light->gpu);
	glGenVertexArrays(1, &light->vertex_array);
	glGenFramebuffers(1, &light->framebuffer);
	return ECO_OK;
}

static void resize(struct web_light *light, uint32_t width, uint32_t height)
{
	if (light->lit && light->width == width && light->height == height)
		return;
	glDeleteTextures(1, &light->lit);
	light->lit = view_gpu_texture(GL_RGBA8, width, height, GL_LINEAR);
	light->width = width;
	light->height = height;
	glBindFramebuffer(GL_FRAMEBUFFER, light->framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light->lit, 0);
}

void web_light_free(struct web_light *light)
{
	const unsigned textures[] = { light->lit, light->shade, light->plants.texture };
	glDeleteTextures(3, textures);
	glDeleteFramebuffers(1, &light->framebuffer);
	glDeleteVertexArrays(1, &light->vertex_array);
	glDeleteProgram(light->program);
	view_gpu_free(&light->gpu);
	*light = (struct web_light){ 0 };
}

void web_light_forget(struct web_light *light)
{
	light->shaded = light->held = false;
}

bool web_light_can(const struct view_light_job *job)
{
	return !job->selection->sky.shadows && !job->selection->image.count;
}

/* ---- What light needs of a selection ---- */

static void put_plant(float *texels, const struct view_light_job *job, const struct view_instance *p)
{
	struct view_light_plant light;
	view_light_plant(job->store, p->plant == ECO_NONE ? NULL : p, p->owner, &light);
	const float a[4] = { light.sine, light.cosine, light.center_z, light.half_width },
		b[4] = { light.half_height, light.tone };
	memcpy(texels, a, sizeof a);
	for (int k = 0; k < 3; k++)
		texels[4 + k] = (float)(p->place.at[k] - job->eye->at[k]);
	texels[7] = (float)p->place.scale;
	memcpy(texels + 8, b, sizeof b);
}

/* Once a selection: feet are told from where the eye was then. */
static enum eco_code upload_plants(struct web_light *light, const struct view_light_job *job,
	struct eco_error *error)
{
	uint32_t count = job->selection->instance_count;
	if (light->held)
		return ECO_OK;
	float *texels = malloc((size_t)count * PLANT_TEXELS * VIEW_TEXEL_BYTES + 1);
	if (!texels)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the plants in view");
	memcpy(light->origin, job->eye->at, sizeof light->origin);
	for (uint32_t i = 0; i < count; i++)
		put_plant(texels + (size_t)i * PLANT_TEXELS * 4, job, &job->selection->instances[i]);
	enum eco_code code = view_gpu_stream(&light->gpu, &light->plants, 4, (const uint32_t *)texels,
		(uint64_t)count * PLANT_TEXELS, error);
	free(texels);
	light->held = !code;
	return code;
}

/* The map of plants' shadows on the ground: it changes with the selection and the sun, not with the eye. */
static enum eco_code upload_shade(struct web_light *light, const struct view_light_job *job,
	struct eco_error *error)
{
	struct view_shade shade = { .size_m = 0 };
	const float *sun = job->selection->sky.sun;
	if (light->shaded && !memcmp(light->sun, sun, sizeof light->sun))
		return ECO_OK;
	enum eco_code code = job->selection->ground.count
		? view_shade_make(&shade, job->store, job->selection, error) : ECO_OK;
	if (code)
		return code;
	if (!light->shade)
		light->shade = view_gpu_texture(GL_RG8, VIEW_SHADE_PIXELS, VIEW_SHADE_PIXELS, GL_LINEAR);
	glBindTexture(GL_TEXTURE_2D, light->shade);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	if (shade.texels)
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, VIEW_SHADE_PIXELS, VIEW_SHADE_PIXELS, GL_RG,
			GL_UNSIGNED_BYTE, shade.texels);
	light->low[0] = shade.low[0];
	light->low[1] = shade.low[1];
	light->side_m = shade.size_m;
	memcpy(light->sun, sun, sizeof light->sun);
	light->shaded = true;
	view_shade_free(&shade);
	return ECO_OK;
}

/* ---- Drawing ---- */

static int uniform(const struct web_light *light, const char *name)
{
	return glGetUniformLocation(light->program, name);
}

static void set_sun(const struct web_light *light, const struct view_light_job *job)
{
	struct view_light_sun sun;
	view_light_sun(&job->selection->sky, job->eye->at[2], &sun);
	glUniform3fv(uniform(light, "u_sun.to"), 1, sun.to);
	glUniform3fv(uniform(light, "u_sun.color"), 1, sun.color);
	glUniform3fv(uniform(light, "u_sun.through"), 1, sun.through);
	glUniform3fv(uniform(light, "u_sun.sky"), 1, sun.sky);
	glUniform3fv(uniform(light, "u_sun.earth"), 1, sun.earth);
	glUniform1f(uniform(light, "u_sun.day"), sun.day);
	glUniform1f(uniform(light, "u_sun.glow"), sun.glow);
	glUniform1f(uniform(light, "u_haze_m"), sun.haze_m);
}

static void set_axis(const struct web_light *light, const char *name, const double axis[3], double length)
{
	glUniform3f(uniform(light, name), (float)(axis[0] * length), (float)(axis[1] * length),
		(float)(axis[2] * length));
}

/* Where the octaves have the eye, and how far a metre to the east and to the north goes in them. */
static void set_octaves(const struct web_light *light, const struct view_light_job *job)
{
	const double *origin = job->selection->ground.origin, *eye = job->eye->at;
	int cell[VIEW_OCTAVES][2];
	float part[VIEW_OCTAVES][2], metre[VIEW_OCTAVES][4];
	for (int i = 0; i < VIEW_OCTAVES; i++) {
		double at[2], zero[2], one[2];
		view_light_octave(i, (const double[2]){ eye[0] - origin[0], eye[1] - origin[1] }, at);
		view_light_octave(i, (const double[2]){ 0, 0 }, zero);
		for (int k = 0; k < 2; k++) {
			double whole = fabs(at[k]) < 1e15 ? floor(at[k]) : at[k];
			cell[i][k] = (int)(uint32_t)(fabs(whole) < 1e15 ? (int64_t)whole : 0);
			part[i][k] = (float)(at[k] - whole);
			view_light_octave(i, (const double[2]){ k == 0, k == 1 }, one);
			metre[i][2 * k] = (float)(one[0] - zero[0]);
			metre[i][2 * k + 1] = (float)(one[1] - zero[1]);
		}
	}
	glUniform2iv(uniform(light, "u_cell"), VIEW_OCTAVES, cell[0]);
	glUniform2fv(uniform(light, "u_part"), VIEW_OCTAVES, part[0]);
	glUniform4fv(uniform(light, "u_metre"), VIEW_OCTAVES, metre[0]);
}

static void bind(const struct web_light *light, const char *name, int unit, unsigned texture)
{
	glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
	glBindTexture(GL_TEXTURE_2D, texture);
	glUniform1i(uniform(light, name), unit);
}

static void set_all(const struct web_light *light, const struct view_light_job *job,
	unsigned seen)
{
	const struct lod_eye *eye = job->eye;
	glUseProgram(light->program);
	bind(light, "u_seen", 0, seen);
	bind(light, "u_plants", 1, light->plants.texture);
	bind(light, "u_shade", 2, light->shade);
	set_sun(light, job);
	set_octaves(light, job);
	set_axis(light, "u_right", eye->right, eye->tan_x);
	set_axis(light, "u_up", eye->up, eye->tan_y);
	set_axis(light, "u_forward", eye->forward, 1);
	glUniform3f(uniform(light, "u_moved"), (float)(eye->at[0] - light->origin[0]),
		(float)(eye->at[1] - light->origin[1]), (float)(eye->at[2] - light->origin[2]));
	glUniform1i(uniform(light, "u_by_kind"), job->tint == VIEW_TINT_KIND);
	glUniform1i(uniform(light, "u_unshaded"), job->tint == VIEW_TINT_UNSHADED);
	glUniform1i(uniform(light, "u_shift"), (int)light->plants.shift);
	glUniform3f(uniform(light, "u_square"), (float)(light->low[0] - eye->at[0]),
		(float)(light->low[1] - eye->at[1]), light->side_m > 0 ? (float)(1 / light->side_m) : 0);
}

enum eco_code web_light_draw(struct web_light *light, const struct view_gl *gl,
	const struct view_light_job *job, uint32_t width, uint32_t height, struct eco_error *error)
{
	enum eco_code code = web_light_prepare(light, error);
	if (!code)
		code = upload_plants(light, job, error);
	if (!code)
		code = upload_shade(light, job, error);
	if (code)
		return code;
	resize(light, width, height);
	set_all(light, job, view_gl_target(gl));
	glBindFramebuffer(GL_FRAMEBUFFER, light->framebuffer);
	web_program_fill(light->vertex_array, (const int[4]){ 0, 0, (int)width, (int)height });
	return ECO_OK;
}

enum eco_code web_light_put(struct web_light *light, const struct view_picture *picture,
	struct eco_error *error)
{
	size_t count = (size_t)picture->width * picture->height;
	uint8_t *rgba = calloc(count, 4);
	enum eco_code code = rgba ? web_light_prepare(light, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	for (size_t i = 0; i < count && !code; i++)
		memcpy(rgba + 4 * i, picture->rgb + 3 * i, 3);
	if (!code) {
		resize(light, picture->width, picture->height);
		glBindTexture(GL_TEXTURE_2D, light->lit);
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)light->width, (GLsizei)light->height,
			GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	}
	free(rgba);
	return code;
}

enum eco_code web_light_read(const struct web_light *light, uint8_t *rgb, struct eco_error *error)
{
	size_t count = (size_t)light->width * light->height;
	uint8_t *rgba = malloc(count * 4);
	if (!rgba)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the colours of a picture");
	glBindFramebuffer(GL_FRAMEBUFFER, light->framebuffer);
	glReadPixels(0, 0, (GLsizei)light->width, (GLsizei)light->height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	for (size_t i = 0; i < count; i++)
		memcpy(rgb + 3 * i, rgba + 4 * i, 3);
	free(rgba);
	return ECO_OK;
}
