#include "client-min/view_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "client-min/view_cache.h"
#include "client-min/view_reference.h"
#include "ecofiles/format/image.h"

static struct view_options given = { .bytes = ECO_BYTES_UNBOUNDED, .samples = 8, .sun_s = NAN,
	.sky = { .shadows = VIEW_SHADOWS_PERSPECTIVE, .shadow_size = VIEW_SHADOW_SIZE } };

static enum eco_code read_frames(const char *text, void *value, struct eco_error *error)
{
	struct view_options *o = value;
	unsigned long long first = 0, last = 0;
	int used = 0;
	if (sscanf(text, "%9llu..%9llu%n", &first, &last, &used) != 2 || text[used] || first > last)
		return eco_fail(error, ECO_BAD_USAGE, "--frames %.100s: must be A..B", text);
	o->frame_first = first;
	o->frame_last = last;
	o->has_frames = true;
	return ECO_OK;
}

static enum eco_code read_reference(const char *text, void *value, struct eco_error *error)
{
	enum view_engine *engine = value;
	*engine = !text ? VIEW_ENGINE_AUTO : !strcmp(text, "cpu") ? VIEW_ENGINE_CPU
		: !strcmp(text, "egl") ? VIEW_ENGINE_EGL : VIEW_ENGINE_NONE;
	return *engine ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "--reference=%.100s: must be one of cpu, "
		"egl", text);
}

static enum eco_code read_marks(const char *text, void *value, struct eco_error *error)
{
	struct eco_error why = { 0 };
	return view_marks_read(value, text, &why) ? eco_fail(error, ECO_BAD_USAGE, "--progressive %s",
		why.text) : ECO_OK;
}

enum eco_code view_time_read(const char *text, void *unix_s, struct eco_error *error)
{
	struct tm t = { 0 };
	const char *at = strptime(text, "%Y-%m-%dT%H:%M", &t), *seconds = at ? strptime(at, ":%S", &t) : NULL;
	at = at ? strptime(seconds ? seconds : at, "%z", &t) : NULL;
	if (!at || *at || t.tm_year < 0)
		return eco_fail(error, ECO_BAD_USAGE,
			"--sun %.60s: must be a time such as 2026-06-21T10:00Z or "
			"2026-06-21T12:00+02:00", text);
	long zone_s = t.tm_gmtoff;               /* which timegm sets to 0 */
	*(double *)unix_s = (double)(timegm(&t) - zone_s);
	return ECO_OK;
}

static enum eco_code read_shadows(const char *text, void *sky, struct eco_error *error)
{
	static const char *const names[] = { "no", "standard", "perspective" };
	struct view_sky *out = sky;
	size_t length = strcspn(text, ",");
	const char *rest = text + length;
	uint64_t size = VIEW_SHADOW_SIZE;
	const char *end;
	int kind = VIEW_SHADOWS_PERSPECTIVE;
	while (kind >= 0 && (length != strlen(names[kind]) || strncmp(text, names[kind], length) != 0))
		kind--;
	bool good = !*rest || (eco_count_read(rest + 1, ECO_OPTION_COUNT, &size, &end) && !*end
		&& size >= VIEW_SHADOW_SIZE_MIN && size <= VIEW_SHADOW_SIZE_MAX);
	if (kind < 0 || !good)
		return eco_fail(error, ECO_BAD_USAGE, "--shadows %.60s: must be no, standard or perspective, "
			"with or without the map's size of %u to %u texels, such as perspective,2048", text,
			VIEW_SHADOW_SIZE_MIN, VIEW_SHADOW_SIZE_MAX);
	out->shadows = (enum view_shadows)kind;
	out->shadow_size = (uint32_t)size;
	return ECO_OK;
}

const char *const view_rules[] = { "optimal", "deussen", NULL };
static const char *const tints[] = { [VIEW_TINT_NONE] = "none", [VIEW_TINT_KIND] = "kind",
	[VIEW_TINT_OWN] = "own", NULL };

static const struct eco_option option_table[] = {
	{ "the scene's URL", 0, ECO_OPTION_INPUT, "URL", .value = &given.url, .is_required = true },
	{ "camera", 0, ECO_OPTION_TEXT, "CAMERA.json", .value = &given.camera, .is_required = true },
	{ "size", 0, ECO_OPTION_SIZE, "WxH", .value = given.size, 1, ECO_IMAGE_MAX, .is_required = true },
	{ "vertices", 0, ECO_OPTION_COUNT, "N", .value = &given.vertices, 0, (double)ECO_VERTICES_MAX,
		.is_required = true },
	{ "output", 'o', ECO_OPTION_TEXT, "DIR", .value = &given.dir, .is_required = true },
	{ "bytes", 0, ECO_OPTION_BYTES, "M", .value = &given.bytes, 0, (double)INT64_MAX },
	{ "memory", 0, ECO_OPTION_BYTES, "SIZE", .value = &given.memory, VIEW_MEMORY_LEAST,
		VIEW_MEMORY_MOST },
	{ "ground-px", 0, ECO_OPTION_NUMBER, "X", .value = &given.ground_px, ECO_GROUND_PX_MIN,
		ECO_GROUND_PX_MAX },
	{ "texel-px", 0, ECO_OPTION_NUMBER, "X", .value = &given.texel_px, ECO_TEXEL_PX_MIN,
		ECO_TEXEL_PX_MAX },
	{ "ahead", 0, ECO_OPTION_NUMBER, "S", .value = &given.ahead_s, 0.001, 3600 },
	{ "snap", 0, ECO_OPTION_NUMBER, "M", .value = &given.snap_m, 0.001, 1000 },
	{ "rule", 0, ECO_OPTION_CHOICE, "NAME", .value = &given.rule, .choices = view_rules },
	{ "reference", 0, ECO_OPTION_READ, "cpu|egl", .value = &given.reference, .read = read_reference,
		.has_optional_value = true },
	{ "digest", 0, ECO_OPTION_FLAG, NULL, .value = &given.digest },
	{ "owners", 0, ECO_OPTION_FLAG, NULL, .value = &given.owners },
	{ "compare", 0, ECO_OPTION_FLAG, NULL, .value = &given.compare },
	{ "truths", 0, ECO_OPTION_TEXT, "DIR", .value = &given.truths },
	{ "geojson", 0, ECO_OPTION_FLAG, NULL, .value = &given.geojson },
	{ "samples", 0, ECO_OPTION_COUNT, "N", .value = &given.samples, 1, LOD_SAMPLES_MAX },
	{ "smooth", 0, ECO_OPTION_FLAG, NULL, .value = &given.smooth },
	{ "sun", 0, ECO_OPTION_READ, "TIME", .value = &given.sun_s, .read = view_time_read },
	{ "shadows", 0, ECO_OPTION_READ, "KIND[,SIZE]", .value = &given.sky, .read = read_shadows },
	{ "haze", 0, ECO_OPTION_NUMBER, "M", .value = &given.sky.haze_m, 1, 1e9 },
	{ "tint", 0, ECO_OPTION_CHOICE, "NAME", .value = &given.tint, .choices = tints },
	{ "chunks", 0, ECO_OPTION_TEXT, "URL", .value = &given.chunks },
	{ "progressive", 0, ECO_OPTION_READ, "LIST", .value = &given.marks, .read = read_marks },
	{ "explain", 0, ECO_OPTION_TEXT, "FILE.csv", .value = &given.explain },
	{ "frames", 0, ECO_OPTION_READ, "A..B", .value = &given, .read = read_frames }, { 0 }
};

const struct eco_command view_command = { .name = "ecoview", .options = option_table,
	.synopsis = "URL --camera CAMERA.json --size WxH --vertices N -o DIR [--bytes M] [--memory SIZE] "
	"[--ground-px X] [--texel-px X] [--ahead S] [--snap M] [--rule NAME] [--reference[=cpu|egl]] "
	"[--compare] [--truths DIR] [--samples N] [--smooth] [--tint NAME] "
	"[--sun TIME] [--shadows KIND[,SIZE]] [--haze M] [--digest] [--owners] [--geojson] "
	"[--frames A..B] [--progressive LIST] [--chunks URL] [--explain FILE.csv]",
	.says = "Streams a scene along a camera script and draws every frame as a PNG.",
	.notes = "Writes frame-0000.png, ...; with --reference also reference-0000.png, frame-0000.mask.png, "
	"reference-0000.mask.png and pr-0000.png (light: right, orange: too much, blue: missing).\n\n"
	"Scores: P and R, Precision and Recall of covered pixels; Q = 1 - distance of (P, R) from (1, 1); "
	"skill, gain over a picture that is covered everywhere; owner_q, Q that counts only pixels of the "
	"right plant; soft_q, Q by the covered part of each pixel; ceiling, the highest Q that the sampling "
	"noise of the reference permits; picture_error, visible difference (mean FLIP), 0 to 1; m16 and s16, "
	"difference of colour (CIELAB) and of contrast (deviation of L*) in blocks of 16 x 16 pixels. The last "
	"three compare with the truth: full detail at 64 samples a pixel, drawn in software.\n" };

enum eco_code view_options_read(int argc, char **argv, struct view_options *o, struct eco_error *error)
{
	enum eco_code code = eco_command_read(&view_command, argc - 1, argv + 1, error);
	*o = given;
	o->width = given.size[0];
	o->height = given.size[1];
	if (!code && (o->compare || o->truths) && !o->reference)
		code = eco_fail(error, ECO_BAD_USAGE, "--%s: needs --reference", o->compare ? "compare" : "truths");
	if (!code && o->chunks && o->marks.bytes_count + o->marks.ms_count)
		code = eco_fail(error, ECO_BAD_USAGE, "--progressive: not with --chunks, whose streams are "
			"drawn once they are whole");
	if (!code && (uint64_t)o->width * o->height > ECO_PIXELS_MAX)
		code = eco_fail(error, ECO_BAD_USAGE, "--size %ux%u: a picture has at most %u pixels",
			o->width, o->height, ECO_PIXELS_MAX);
	return code;
}
