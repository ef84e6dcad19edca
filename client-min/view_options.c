#include "client-min/view_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "client-min/view_cache.h"
#include "client-min/view_reference.h"
#include "ecofiles/format/image.h"

static struct view_options given = { .bytes = ECO_BYTES_UNBOUNDED, .sun_s = NAN };

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

static bool read_zone(const char *text, int *minutes)
{
	int hours, rest, used = 0;
	char sign;
	*minutes = 0;
	if (text[0] == 'Z' && !text[1])
		return true;
	if (sscanf(text, "%c%2d:%2d%n", &sign, &hours, &rest, &used) != 3 || text[used]
			|| (sign != '+' && sign != '-') || hours < 0 || hours > 14 || rest < 0 || rest > 59)
		return false;
	*minutes = (sign == '-' ? -1 : 1) * (hours * 60 + rest);
	return true;
}

enum eco_code view_time_read(const char *text, void *unix_s, struct eco_error *error)
{
	struct tm t = { 0 };
	int used = 0, more = 0, zone;
	bool good = sscanf(text, "%4d-%2d-%2dT%2d:%2d%n", &t.tm_year, &t.tm_mon, &t.tm_mday, &t.tm_hour,
		&t.tm_min, &used) == 5;
	if (good && text[used] == ':')
		good = sscanf(text + used, ":%2d%n", &t.tm_sec, &more) == 1;
	good = good && read_zone(text + used + more, &zone) && t.tm_year >= 1900 && t.tm_mon >= 1
		&& t.tm_mon <= 12 && t.tm_mday >= 1 && t.tm_mday <= 31 && t.tm_hour >= 0 && t.tm_hour < 24
		&& t.tm_min >= 0 && t.tm_min < 60 && t.tm_sec >= 0 && t.tm_sec < 60;
	if (!good)
		return eco_fail(error, ECO_BAD_USAGE,
			"--sun %.60s: must be a time such as 2026-06-21T10:00Z or "
			"2026-06-21T12:00+02:00", text);
	t.tm_year -= 1900;
	t.tm_mon -= 1;
	*(double *)unix_s = (double)timegm(&t) - 60.0 * zone;
	return ECO_OK;
}

static enum eco_code read_shadows(const char *text, void *sky, struct eco_error *error)
{
	static const char *const names[] = { [VIEW_SHADOWS_STANDARD] = "standard",
		[VIEW_SHADOWS_PERSPECTIVE] = "perspective" };
	struct view_sky *out = sky;
	size_t length = strcspn(text, ",");
	const char *rest = text + length;
	uint64_t size = VIEW_SHADOW_SIZE;
	const char *end;
	for (int i = VIEW_SHADOWS_STANDARD; i <= VIEW_SHADOWS_PERSPECTIVE; i++)
		if (length == strlen(names[i]) && strncmp(text, names[i], length) == 0)
			out->shadows = (enum view_shadows)i;
	bool good = !*rest || (eco_count_read(rest + 1, ECO_OPTION_COUNT, &size, &end) && !*end
		&& size >= VIEW_SHADOW_SIZE_MIN && size <= VIEW_SHADOW_SIZE_MAX);
	if (!out->shadows || !good)
		return eco_fail(error, ECO_BAD_USAGE, "--shadows %.60s: must be standard or perspective, with "
			"or without the map's size of %u to %u texels, such as perspective,2048", text,
			VIEW_SHADOW_SIZE_MIN, VIEW_SHADOW_SIZE_MAX);
	out->shadow_size = (uint32_t)size;
	return ECO_OK;
}

const char *const view_rules[] = { "optimal", "deussen", NULL };
static const char *const tints[] = { [VIEW_TINT_NONE] = "none", [VIEW_TINT_KIND] = "kind",
	[VIEW_TINT_OWN] = "own", NULL };

static const struct eco_option option_table[] = {
	{ "the scene's URL", 0, ECO_OPTION_INPUT, "URL", &given.url,
		.help = "of a scene: http://host:port/v1/scenes/NAME", .is_required = true },
	{ "camera", 0, ECO_OPTION_TEXT, "CAMERA.json", &given.camera, .help = "camera script",
		.is_required = true },
	{ "size", 0, ECO_OPTION_SIZE, "WxH", given.size, 1, ECO_IMAGE_MAX, .is_required = true,
		.help = "of the pictures, in pixels; at most 16384 either way and 2^26 in all" },
	{ "vertices", 0, ECO_OPTION_COUNT, "N", &given.vertices, 0, ECO_VERTICES_MAX, .is_required = true,
		.help = "budget a frame: points + 2 lines + 3 triangles drawn, instances counted" },
	{ "output", 'o', ECO_OPTION_TEXT, "DIR", &given.dir, .is_required = true,
		.help = "where pictures and report.json go; made if missing" },
	{ "bytes", 0, ECO_OPTION_BYTES, "M", &given.bytes, 0, INT64_MAX,
		.help = "budget of each response; none if not given. Where not all fits, nothing coarser comes "
		"first, and there is no picture before most of them" },
	{ "memory", 0, ECO_OPTION_BYTES, "SIZE", &given.memory, VIEW_MEMORY_LEAST, VIEW_MEMORY_MOST,
		.help = "of decoded data held, such as 64M; 8G if not given: what was not needed "
		"for the longest time goes, and is fetched again where it is needed; not of the reference" },
	{ "ground-px", 0, ECO_OPTION_NUMBER, "X", &given.ground_px, ECO_GROUND_PX_MIN, ECO_GROUND_PX_MAX,
		.help = "how far the ground may be from where it is, 0.01 to 65536 pixels; 1 if not given" },
	{ "texel-px", 0, ECO_OPTION_NUMBER, "X", &given.texel_px, ECO_TEXEL_PX_MIN, ECO_TEXEL_PX_MAX,
		.help = "how wide a texture's texels may be where it has finer, 0.000001 to 65536 pixels; "
		"0.03125 if not given" },
	{ "ahead", 0, ECO_OPTION_NUMBER, "S", &given.ahead_s, 0.001, 3600,
		.help = "also ask for what the script's view so many seconds later will need; it comes last, "
		"within --bytes, and is not waited for once the script looks elsewhere, but with --chunks" },
	{ "snap", 0, ECO_OPTION_NUMBER, "M", &given.snap_m, 0.001, 1000,
		.help = "eye and target stand on a grid of so many metres, so that views that are nearly "
		"alike are answered by one plan; each moves by at most .87 of that" },
	{ "rule", 0, ECO_OPTION_CHOICE, "NAME", &given.rule, .choices = view_rules,
		.help = "how the server spends the budget: optimal (the default), or deussen (Deussen "
		"2002), to compare with" },
	{ "reference", 0, ECO_OPTION_READ, "cpu|egl", &given.reference, .read = read_reference,
		.has_optional_value = true,
		.help = "also draw everything at full detail, and score; by default with OpenGL on "
		"hardware, else in software" },
	{ "digest", 0, ECO_OPTION_FLAG, NULL, &given.digest,
		.help = "says of each frame by two hashes what was decoded and is drawn, as a browser does" },
	{ "owners", 0, ECO_OPTION_FLAG, NULL, &given.owners,
		.help = "also whose each pixel is, as frame-0000.owners.png: a colour for each plant, the "
		"same in all frames, and black for what is none's" },
	{ "compare", 0, ECO_OPTION_FLAG, NULL, &given.compare,
		.help =
		"with the reference: also ours, full detail and the error that people see (FLIP) side by "
		"side, with their numbers, as compare-0000.png" },
	{ "geojson", 0, ECO_OPTION_FLAG, NULL, &given.geojson,
		.help = "also which plants are seen, as frame-0000.geojson: longitude and latitude (metres "
		"where the scene has no CRS), species and what it is shown as, height, pixels, distance, how "
		"each is drawn, and which row of which inventory it is" },
	{ "sun", 0, ECO_OPTION_READ, "TIME", &given.sun_s, .read = view_time_read,
		.help = "where the sun is at that time and the scene's place, such as 2026-06-21T10:00Z" },
	{ "shadows", 0, ECO_OPTION_READ, "KIND[,SIZE]", &given.sky, .read = read_shadows,
		.help = "plants cast shadows on plants and ground, by a map of SIZE x SIZE texels (1024 if "
		"not given): standard, of texels of one size, or perspective, with more of them near the "
		"eye; of plants out of sight those that are held, as nothing is fetched for it" },
	{ "haze", 0, ECO_OPTION_NUMBER, "M", &given.sky.haze_m, 1, 1e9,
		.help = "metres after which haze hides all but 1/e, at sea level; 5200 if not given" },
	{ "tint", 0, ECO_OPTION_CHOICE, "NAME", &given.tint, .choices = tints,
		.help = "kind: colour by representation: green triangles, red lines, blue points, yellow and "
		"orange blends, violet ellipsoids for whole plants; own: plants in their own colours, "
		"without light, on gray ground before a black sky" },
	{ "chunks", 0, ECO_OPTION_TEXT, "URL", &given.chunks,
		.help = "fetch chunks of 1024 bytes or more by their names from URL/NAME: the scene's "
		"URL/chunks, or a static host of what `ecopack export` wrote; others come with the stream, "
		"and all of them once the host hangs" },
	{ "progressive", 0, ECO_OPTION_READ, "LIST", &given.marks, .read = read_marks,
		.help = "also draw what is there while an answer comes: after so many bytes or milliseconds, "
		"such as 20000,50000,200ms; frame-0000-part-00.png, ... are the frames of a film, one for "
		"each until the answer is whole" },
	{ "explain", 0, ECO_OPTION_TEXT, "FILE.csv", &given.explain,
		.help = "a table of why each cut of each frame is what it is; the server plans twice for "
		"it" },
	{ "frames", 0, ECO_OPTION_READ, "A..B", &given, .read = read_frames,
		.help = "only these frames of the script (inclusive)" }, { 0 } };

const struct eco_command view_command = { .name = "ecoview", .options = option_table,
	.synopsis = "URL --camera CAMERA.json --size WxH --vertices N -o DIR [--bytes M] [--memory SIZE] "
	"[--ground-px X] [--texel-px X] [--ahead S] [--snap M] [--rule NAME] [--reference[=cpu|egl]] [--compare] "
	"[--tint NAME] "
	"[--sun TIME] [--shadows KIND[,SIZE]] [--haze M] [--digest] [--owners] [--geojson] "
	"[--frames A..B] [--progressive LIST] [--chunks URL] [--explain FILE.csv]",
	.says = "Streams a scene along a camera script and draws every frame as a PNG.",
	.notes = "Writes frame-0000.png, ...; with --reference also reference-0000.png, frame-0000.mask.png, "
	"reference-0000.mask.png and pr-0000.png (light: right, orange: too much, blue: missing).\n\n"
	"Scores: P and R, Precision and Recall of covered pixels; Q, 1 less the distance of P and R from 1; "
	"skill, the gain over a picture with all covered; owner_q, Q where only the right plant counts; "
	"soft_q, Q of how much of each pixel is covered; ceiling, the best Q without the reference's own "
	"chance; picture_error, what people see of the difference (mean FLIP), 0 to 1.\n" };

enum eco_code view_options_read(int argc, char **argv, struct view_options *o, struct eco_error *error)
{
	enum eco_code code = eco_command_read(&view_command, argc - 1, argv + 1, error);
	*o = given;
	o->width = given.size[0];
	o->height = given.size[1];
	if (!code && o->compare && !o->reference)
		code = eco_fail(error, ECO_BAD_USAGE, "--compare: needs --reference");
	if (!code && o->chunks && o->marks.bytes_count + o->marks.ms_count)
		code = eco_fail(error, ECO_BAD_USAGE, "--progressive: not with --chunks, whose streams are "
			"drawn once they are whole");
	if (!code && (uint64_t)o->width * o->height > ECO_PIXELS_MAX)
		code = eco_fail(error, ECO_BAD_USAGE, "--size %ux%u: a picture has at most %u pixels",
			o->width, o->height, ECO_PIXELS_MAX);
	return code;
}
