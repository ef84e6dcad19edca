/* ecoload: many clients at once, counting what a server does right and wrong. */
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>

#include "client-min/view_load.h"
#include "client-min/view_progress.h"
#include "ecofiles/base/options.h"

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
}

struct options { struct view_load_options load; const char *camera; uint64_t clients; uint32_t size[2];
	bool json; };

static struct options given = { .load = { .vertices = 1000000, .bytes = ECO_BYTES_UNBOUNDED },
	.size = { 800, 600 } };

static const struct eco_option option_table[] = {
	{ "the scene's URL", 0, ECO_OPTION_INPUT, "URL", &given.load.url,
		.help = "of a scene: http://host:port/v1/scenes/NAME",
		.is_required = true },
	{ "camera", 0, ECO_OPTION_TEXT, "CAMERA.json", &given.camera, .help = "camera script",
		.is_required = true },
	{ "clients", 0, ECO_OPTION_COUNT, "N", &given.clients, 1, 1000, .help = "1 to 1000",
		.is_required = true },
	{ "seconds", 0, ECO_OPTION_NUMBER, "S", &given.load.seconds, 0.001, 1e6, .help = "how long",
		.is_required = true },
	{ "vertices", 0, ECO_OPTION_COUNT, "N", &given.load.vertices, 0, ECO_VERTICES_MAX,
		.help = "budget a frame; 1000000 if not given" },
	{ "bytes", 0, ECO_OPTION_COUNT, "M", &given.load.bytes, 0, INT64_MAX,
		.help = "budget of each response; none if not given" },
	{ "size", 0, ECO_OPTION_SIZE, "WxH", given.size, 1, ECO_IMAGE_MAX,
		.help = "of the views; 800x600 if not given" },
	{ "json", 0, ECO_OPTION_FLAG, NULL, &given.json, .help = "figures as JSON" }, { 0 } };

static const struct eco_command command = { .name = "ecoload", .options = option_table,
	.synopsis = "URL --camera CAMERA.json --clients N --seconds S [--vertices N] [--bytes M] [--size "
	"WxH] [--json]",
	.says = "N clients walk a camera script, each from its own place in it, asking for the next frame "
	"as soon as the last is decoded. "
		"Every answer is decoded and its vertices are counted anew from what was decoded. A client "
		"that is refused because the server "
		"has too much to do waits as long as it asks for.",
	.notes = "Failures and violations of budgets are failures of ecoload, too.\n" };

struct progress { struct view_progress bar; double seconds; };

static void on_tick(void *ctx, double gone)
{
	struct progress *p = ctx;
	view_progress_show(&p->bar, gone < p->seconds ? gone : p->seconds, p->seconds, "asking");
}

/* ---- Figures ---- */

static const struct { const char *name; double share; } quantiles[] = { { "p50", 0.5 }, { "p90", 0.9 },
	{ "p99", 0.99 }, { "max", 1 } };
#define QUANTILES (sizeof quantiles / sizeof quantiles[0])

static void print_times(const char *name, const struct view_times *times)
{
	printf("%-14s", name);
	for (size_t i = 0; i < QUANTILES; i++) {
		double ms = view_times_quantile(times, quantiles[i].share);
		isfinite(ms) ? printf("  %s %.1f", quantiles[i].name, ms)
			: printf("  %s -", quantiles[i].name);
	}
	puts(" ms");
}

static void print_text(const struct view_load_report *r)
{
	printf("requests        %llu in %.1f s: %.1f /s, %.2f MB/s\n", (unsigned long long)r->requests,
		r->seconds, (double)r->requests / r->seconds, (double)r->bytes / r->seconds / 1e6);
	print_times("latency", &r->latency);
	print_times("first byte", &r->first_byte);
	printf("chunks          %llu decoded, %llu sent twice; %llu answers without a picture\n",
		(unsigned long long)r->chunks, (unsigned long long)r->chunks_twice,
		(unsigned long long)r->nothing);
	if (r->renewed)
		printf("packs           %llu times a client began anew, as the scene had another\n",
			(unsigned long long)r->renewed);
	printf("violations      vertices %llu, bytes %llu\n", (unsigned long long)r->vertex_violations,
		(unsigned long long)r->byte_violations);
	printf("failures       ");
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		printf(" %s %llu%s", view_load_failure_names[i], (unsigned long long)r->failures[i],
			i + 1 < VIEW_LOAD_FAILURES ? "," : "\n");
	if (r->first_failure[0])
		printf("the first       %s\n", r->first_failure);
}

static json_t *times_json(const struct view_times *times)
{
	json_t *o = json_object();
	for (size_t i = 0; i < QUANTILES; i++) {
		double v = view_times_quantile(times, quantiles[i].share);
		json_object_set_new(o, quantiles[i].name, isfinite(v) ? json_real(v) : json_null());
	}
	return o;
}

static void print_json(const struct view_load_report *r, const struct options *options)
{
	json_t *failures = json_object(), *first = r->first_failure[0] ? json_string(r->first_failure) : NULL;
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		json_object_set_new(failures, view_load_failure_names[i],
			json_integer((json_int_t)r->failures[i]));
	json_t *o = json_pack("{s:I, s:f, s:I, s:f, s:I, s:f, s:o, s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:o, "
		"s:o}",
		"clients", (json_int_t)options->load.clients, "seconds", r->seconds,
		"requests", (json_int_t)r->requests, "requests_per_s", (double)r->requests / r->seconds,
		"bytes", (json_int_t)r->bytes, "bytes_per_s", (double)r->bytes / r->seconds,
		"latency_ms", times_json(&r->latency), "first_byte_ms", times_json(&r->first_byte),
		"vertices", (json_int_t)r->vertices, "chunks", (json_int_t)r->chunks,
		"chunks_twice", (json_int_t)r->chunks_twice, "nothing", (json_int_t)r->nothing,
		"vertex_violations", (json_int_t)r->vertex_violations,
		"byte_violations", (json_int_t)r->byte_violations, "failures", failures,
		"first_failure", first ? first : json_null());
	json_object_set_new(o, "renewed", json_integer((json_int_t)r->renewed));
	json_dumpf(o, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
	putchar('\n');
	json_decref(o);
}

static enum eco_code run(struct options *o, struct eco_error *error)
{
	struct eco_camera *camera = NULL;
	struct view_load_report report;
	struct progress progress = { .seconds = o->load.seconds };
	enum eco_code code = eco_camera_load(&camera, o->camera, error);
	if (code)
		return code;
	view_progress_begin(&progress.bar, "ecoload");
	o->load.camera = camera;
	o->load.stop = &interrupted;
	o->load.tick = on_tick;
	o->load.ctx = &progress;
	code = view_load_run(&report, &o->load, error);
	view_progress_clear(&progress.bar);
	if (!code) {
		if (o->json)
			print_json(&report, o);
		else
			print_text(&report);
		if (!view_load_clean(&report))
			code = eco_fail(error, ECO_DAMAGED, "there were failures or violations, or no "
				"answer at all");
		view_load_free(&report);
	}
	eco_camera_free(camera);
	return code;
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	struct sigaction action = { .sa_handler = on_signal };
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	action.sa_flags = (int)SA_RESETHAND;
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, &error);
	given.load.clients = (uint32_t)given.clients;
	given.load.width = given.size[0];
	given.load.height = given.size[1];
	if (!code)
		code = view_fetch_setup(&error);
	if (!code)
		code = run(&given, &error);
	view_fetch_teardown();
	return eco_command_end(&command, code, &error);
}
