/* Full detail of a flight's frames, and x264 of it.
 *
 * A video is of BT.601 in the limited range, its chroma at each pixel (4:4:4) or the mean of 2 x 2 (4:2:0),
 * which comes back interpolated between these: what the video loses so counts as its error. x264 reads frames
 * from a pipe (--preset slow, no key frame after the first, a constant rate factor) and writes its own
 * reconstruction beside the stream, which is of naked NAL units: no container's bytes are counted. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lod/raster/flip.h"
#include "tests/bench/bench_state.h"
#include "tests/bench/pictures/bench_flight.h"

#define WIDTH BENCH_SHOT_WIDTH
#define HEIGHT BENCH_SHOT_HEIGHT
#define PIXELS BENCH_FLIGHT_PIXELS
#define FRAME_BYTES (3 * PIXELS)
#define FULL_BYTES (PIXELS * (3 + 1 + sizeof(uint64_t)))       /* rgb, cover, owner */
#define PATH 1400

/* ---- Colours ---- */

static const double luma[3] = { 0.299, 0.587, 0.114 };

static uint8_t to_byte(double v) { return (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : lrint(v)); }

/* One sample of chroma for side x side pixels, side 1 or 2. */
static size_t yuv_bytes(size_t side) { return PIXELS + 2 * PIXELS / (side * side); }

static void to_yuv(const uint8_t *rgb, size_t side, uint8_t *yuv)
{
	uint8_t *blue = yuv + PIXELS, *red = blue + PIXELS / (side * side);
	for (size_t y = 0; y < HEIGHT; y += side)
		for (size_t x = 0; x < WIDTH; x += side) {
			double sum[2] = { 0, 0 }, share = 224 / 255.0 / (double)(side * side);
			for (size_t i = 0; i < side * side; i++) {
				size_t at = (y + i / side) * WIDTH + x + i % side;
				const uint8_t *c = rgb + 3 * at;
				double l = luma[0] * c[0] + luma[1] * c[1] + luma[2] * c[2];
				yuv[at] = to_byte(16 + 219 / 255.0 * l);
				sum[0] += (c[2] - l) / (2 - 2 * luma[2]);
				sum[1] += (c[0] - l) / (2 - 2 * luma[0]);
			}
			*blue++ = to_byte(128 + share * sum[0]);
			*red++ = to_byte(128 + share * sum[1]);
		}
}

/* Of 4:2:0, 3 : 1 between the nearest in each direction, as samples lie amid 2 x 2 pixels. */
static double chroma_at(const uint8_t *plane, size_t side, size_t x, size_t y)
{
	size_t at[2] = { x, y }, last[2] = { WIDTH / 2 - 1, HEIGHT / 2 - 1 }, near[2], far[2];
	if (side == 1)
		return plane[y * WIDTH + x] - 128;
	for (int k = 0; k < 2; k++) {
		near[k] = at[k] / 2;
		far[k] = at[k] & 1 ? near[k] + (near[k] < last[k]) : near[k] - (near[k] > 0);
	}
	const uint8_t *row = plane + near[1] * (WIDTH / 2), *next = plane + far[1] * (WIDTH / 2);
	return (9 * row[near[0]] + 3 * row[far[0]] + 3 * next[near[0]] + next[far[0]]) / 16.0 - 128;
}

static void to_rgb(const uint8_t *yuv, size_t side, uint8_t *rgb)
{
	const uint8_t *blue = yuv + PIXELS, *red = blue + PIXELS / (side * side);
	for (size_t y = 0; y < HEIGHT; y++)
		for (size_t x = 0; x < WIDTH; x++) {
			uint8_t *c = rgb + 3 * (y * WIDTH + x);
			double l = (yuv[y * WIDTH + x] - 16) * 255 / 219.0,
				b = l + chroma_at(blue, side, x, y) * 255 / 224 * (2 - 2 * luma[2]),
				r = l + chroma_at(red, side, x, y) * 255 / 224 * (2 - 2 * luma[0]);
			c[0] = to_byte(r);
			c[1] = to_byte((l - luma[0] * r - luma[2] * b) / luma[1]);
			c[2] = to_byte(b);
		}
}

/* ---- Files ---- */

static bool has_size(const char *path, size_t size)
{
	struct stat status;
	return !stat(path, &status) && (size_t)status.st_size == size;
}

/* `size` bytes from `offset` on; false where they are not there. */
static bool read_at(const char *path, size_t offset, uint8_t *bytes, size_t size)
{
	FILE *file = fopen(path, "rb");
	bool good = file && !fseeko(file, (off_t)offset, SEEK_SET) && fread(bytes, 1, size, file) == size;
	if (file)
		fclose(file);
	return good;
}

enum eco_code bench_flight_keep(const struct bench_flight *flight, const char *what, const uint8_t *rgb,
	struct eco_error *error)
{
	char path[PATH];
	snprintf(path, sizeof path, "%s-%s.rgb", flight->files, what);
	return bench_file_write(path, (const char *)rgb, 3 * PIXELS, error);
}

bool bench_flight_kept(const struct bench_flight *flight, const char *what, uint8_t *rgb)
{
	char path[PATH];
	snprintf(path, sizeof path, "%s-%s.rgb", flight->files, what);
	return read_at(path, 0, rgb, 3 * PIXELS);
}

/* ---- Full detail ---- */

/* All colours of the n-th piece; and colours, cover and owners of its scored frame. */
static void name_piece(const struct bench_flight *flight, uint32_t n, char colours[PATH], char full[PATH])
{
	snprintf(colours, PATH, "%s-%u.frames", flight->files, n);
	snprintf(full, PATH, "%s-%u.full", flight->files, n);
}

static enum eco_code write_full(const char *path, const struct view_picture *picture, struct eco_error *error)
{
	uint8_t *bytes = malloc(FULL_BYTES);
	if (!bytes)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	memcpy(bytes, picture->rgb, 3 * PIXELS);
	memcpy(bytes + 3 * PIXELS, picture->cover, PIXELS);
	memcpy(bytes + 4 * PIXELS, picture->owner, PIXELS * sizeof(uint64_t));
	enum eco_code code = bench_file_write(path, (const char *)bytes, FULL_BYTES, error);
	free(bytes);
	return code;
}

enum eco_code bench_flight_full(const struct bench_flight *flight, uint32_t n, struct view_picture *picture,
	struct eco_error *error)
{
	char colours[PATH], path[PATH];
	name_piece(flight, n, colours, path);
	enum eco_code code = view_picture_init(picture, WIDTH, HEIGHT, error);
	if (!code && (!read_at(path, 0, picture->rgb, 3 * PIXELS)
			|| !read_at(path, 3 * PIXELS, picture->cover, PIXELS)
			|| !read_at(path, 4 * PIXELS, (uint8_t *)picture->owner, PIXELS * sizeof(uint64_t))))
		code = eco_fail(error, ECO_IO, "%s: cannot be read", path);
	return code;
}

/* The n-th piece. *client is opened when it is first needed. */
static enum eco_code draw_piece(struct bench *bench, const struct bench_flight *flight, uint32_t n,
	struct bench_client **client, double *draw_ms, struct eco_error *error)
{
	char colours[PATH], full[PATH];
	uint8_t *frames = malloc(flight->every * FRAME_BYTES);
	enum eco_code code = frames ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for pictures");
	if (!code && !*client)
		code = bench_client_open(client, flight->pack, error);
	name_piece(flight, n, colours, full);
	for (uint32_t i = 0; i < flight->every && !code; i++) {
		struct eco_request request = { .view = flight->views[n * flight->every + i] };
		double ms;
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: bench_client_reference(*client, &request, &ms, error);
		if (code)
			break;
		*draw_ms += ms / flight->every;
		memcpy(frames + i * FRAME_BYTES, bench_client_full(*client)->rgb, FRAME_BYTES);
		if (n * flight->every + i == bench_flight_frame(flight, n))
			code = write_full(full, bench_client_full(*client), error);
	}
	if (!code)
		code = bench_file_write(colours, (const char *)frames, flight->every * FRAME_BYTES, error);
	free(frames);
	return code;
}

enum eco_code bench_flight_reference(struct bench *bench, const struct bench_flight *flight, double *draw_ms,
	struct eco_error *error)
{
	struct bench_client *client = NULL;
	enum eco_code code = ECO_OK;
	*draw_ms = 0;
	for (uint32_t n = 0; n < bench_flight_scored(flight) && !code; n++) {
		char unit[96], colours[PATH], full[PATH];
		double ms = 0;
		snprintf(unit, sizeof unit, "flight-%s-%u-full-%u", flight->scene, flight->count, n);
		name_piece(flight, n, colours, full);
		bool there = has_size(colours, flight->every * FRAME_BYTES) && has_size(full, FULL_BYTES);
		json_t *row = there ? bench_recall(bench, unit, flight->stamp) : NULL;
		bench_progress(bench, 0.3 * n / bench_flight_scored(flight), flight->scene);
		if (!row)
			code = draw_piece(bench, flight, n, &client, &ms, error);
		if (!row && !code)
			row = bench_keep(bench, unit, flight->stamp, json_real(ms));
		*draw_ms += json_number_value(row) / bench_flight_scored(flight);
	}
	bench_client_close(client);
	return code;
}

/* ---- Video ---- */

bool bench_flight_has_x264(void) { return !system("command -v x264 >/dev/null 2>&1"); }

static size_t side_of(const struct bench_flight_coding *coding) { return coding->whole_chroma ? 1 : 2; }

static enum eco_code score_video(const struct bench_flight *flight, size_t side, const char *yuv,
	const char *what, double *picture_error, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	uint8_t *frame = malloc(yuv_bytes(side) + FRAME_BYTES), *rgb = frame + yuv_bytes(side);
	if (!frame)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	*picture_error = 0;
	for (uint32_t n = 0; n < bench_flight_scored(flight) && !code; n++) {
		struct view_picture full = { 0 };
		double one = 0;
		if (!read_at(yuv, bench_flight_frame(flight, n) * yuv_bytes(side), frame, yuv_bytes(side)))
			code = eco_fail(error, ECO_IO, "%s: x264 wrote too few frames", yuv);
		if (!code)
			code = bench_flight_full(flight, n, &full, error);
		if (!code) {
			to_rgb(frame, side, rgb);
			code = lod_flip(&(struct lod_flip_input){ WIDTH, HEIGHT, rgb, full.rgb, NULL }, &one,
				error);
		}
		if (!code && n == BENCH_FLIGHT_SHOWN(flight))
			code = bench_flight_keep(flight, what, rgb, error);
		*picture_error += one / bench_flight_scored(flight);
		view_picture_free(&full);
	}
	free(frame);
	return code;
}

static enum eco_code feed_frames(struct bench *bench, const struct bench_flight *flight, size_t side,
	FILE *to, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	uint8_t *rgb = malloc(FRAME_BYTES + yuv_bytes(side)), *yuv = rgb + FRAME_BYTES;
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	for (uint32_t f = 0; f < flight->count && !code; f++) {
		char colours[PATH], full[PATH];
		name_piece(flight, f / flight->every, colours, full);
		if (bench_stopped(bench))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
		else if (!read_at(colours, f % flight->every * FRAME_BYTES, rgb, FRAME_BYTES))
			code = eco_fail(error, ECO_IO, "%s: cannot be read", colours);
		if (code)
			break;
		to_yuv(rgb, side, yuv);
		if (fwrite(yuv, 1, yuv_bytes(side), to) != yuv_bytes(side))
			code = eco_fail(error, ECO_IO, "x264 does not read its frames; its message is above");
	}
	free(rgb);
	return code;
}

/* x264 writes `stream`, and its reconstruction to `yuv`. */
static enum eco_code run_x264(struct bench *bench, const struct bench_flight *flight,
	const struct bench_flight_coding *coding, const char *stream, const char *yuv,
	struct eco_error *error)
{
	char command[3 * PATH];
	const char *chroma = coding->whole_chroma ? "i444" : "i420";
	snprintf(command, sizeof command, "x264 --quiet --no-progress --demuxer raw --input-csp %s "
		"--output-csp %s --input-res %ux%u --fps %u --preset slow --keyint infinite --threads 2 "
		"--crf %u --dump-yuv '%s' -o '%s' - 2>&1 | grep -Ev '^(encoded|$)' >&2", chroma, chroma,
		WIDTH, HEIGHT, BENCH_FLIGHT_FPS, coding->crf, yuv, stream);
	void (*was)(int) = signal(SIGPIPE, SIG_IGN);
	FILE *to = popen(command, "w");
	enum eco_code code = to ? feed_frames(bench, flight, side_of(coding), to, error)
		: eco_fail(error, ECO_IO, "x264 cannot be started");
	if (to)
		pclose(to);
	signal(SIGPIPE, was);
	return code;
}

static enum eco_code encode(struct bench *bench, const struct bench_flight *flight,
	const struct bench_flight_coding *coding, const char *what, json_t **row, struct eco_error *error)
{
	char stream[PATH], yuv[PATH];
	struct stat status;
	double picture_error = NAN;
	snprintf(stream, sizeof stream, "%s-%s.264", flight->files, what);
	snprintf(yuv, sizeof yuv, "%s-%s.yuv", flight->files, what);
	enum eco_code code = run_x264(bench, flight, coding, stream, yuv, error);
	if (!code && stat(stream, &status))
		code = eco_fail(error, ECO_IO, "%s: x264 wrote nothing; its message is above", stream);
	if (!code)
		code = score_video(flight, side_of(coding), yuv, what, &picture_error, error);
	unlink(yuv);
	unlink(stream);
	if (!code)
		*row = json_pack("{s:I, s:f}", "bytes", (json_int_t)status.st_size, "picture_error",
			picture_error);
	return code;
}

void bench_flight_coding_name(const struct bench_flight_coding *coding, char name[32])
{
	snprintf(name, 32, "%s-crf%u", coding->whole_chroma ? "444" : "420", coding->crf);
}

enum eco_code bench_flight_video(struct bench *bench, const struct bench_flight *flight,
	const struct bench_flight_coding *coding, json_t **row, struct eco_error *error)
{
	char what[32], unit[96];
	enum eco_code code = ECO_OK;
	bench_flight_coding_name(coding, what);
	snprintf(unit, sizeof unit, "flight-%s-%u-%s", flight->scene, flight->count, what);
	*row = bench_recall(bench, unit, flight->stamp);
	if (*row)
		return ECO_OK;
	code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
		: encode(bench, flight, coding, what, row, error);
	*row = code ? NULL : bench_keep(bench, unit, flight->stamp, *row);
	return code;
}
