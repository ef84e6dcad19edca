/* ecoload: many clients at once, counting what a server does right and wrong. */
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "client-min/view_load.h"
#include "client-min/view_options.h"
#include "client-min/view_progress.h"

static const char usage[] =
	"usage: ecoload URL --camera CAMERA.json --clients N --seconds S [--vertices N] [--bytes M] [--size WxH] [--json]\n"
	"\n"
	"N clients walk a camera script, each from its own place in it, asking for the next frame as soon as the last is decoded.\n"
	"Every answer is decoded and its vertices are counted anew from what was decoded. A client that is refused because the server has too\n"
	"much to do waits as long as it asks for.\n"
	"\n"
	"  URL             of a scene: http://host:port/v1/scenes/NAME\n"
	"  --camera FILE   camera script\n"
	"  --clients N     1..1000\n"
	"  --seconds S     how long\n"
	"  --vertices N    budget a frame (1000000)\n"
	"  --bytes M       budget of each response (none)\n"
	"  --size WxH      of the views (800x600)\n"
	"  --json          figures as JSON\n"
	"  --help  --version\n"
	"\n"
	"Exit status: 0 no failures and no violations, 1 otherwise, 2 usage.\n";

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
}

struct options { struct view_load_options load; const char *camera; bool json; };

static enum eco_code parse_one(int argc, char **argv, int *i, struct options *o, struct eco_error *error)
{
	const char *value;
	uint64_t count = 0;
	if (view_option(argc, argv, i, "--camera", &value))
		return (o->camera = value) ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "--camera takes a file");
	if (view_option(argc, argv, i, "--clients", &value)) {
		enum eco_code code = view_parse_count("--clients", value, 1, 1000, &count, error);
		o->load.clients = (uint32_t)count;
		return code;
	}
	if (view_option(argc, argv, i, "--seconds", &value))
		return view_parse_seconds("--seconds", value, &o->load.seconds, error);
	if (view_option(argc, argv, i, "--vertices", &value))
		return view_parse_count("--vertices", value, 0, ECO_VERTICES_MAX, &o->load.vertices, error);
	if (view_option(argc, argv, i, "--bytes", &value))
		return view_parse_count("--bytes", value, 0, ECO_BYTES_UNBOUNDED - 1, &o->load.bytes, error);
	if (view_option(argc, argv, i, "--size", &value))
		return view_parse_size("--size", value, &o->load.width, &o->load.height, error);
	if (view_flag(argv, i, "--json"))
		return o->json = true, ECO_OK;
	if (argv[*i][0] == '-' || o->load.url)
		return eco_fail(error, ECO_BAD_USAGE, argv[*i][0] == '-' ? "unknown option '%s'" : "one URL at a time: '%s' is a second", argv[*i]);
	o->load.url = argv[(*i)++];
	return ECO_OK;
}

static enum eco_code parse(int argc, char **argv, struct options *o, struct eco_error *error)
{
	*o = (struct options){ .load = { .width = 800, .height = 600, .vertices = 1000000, .bytes = ECO_BYTES_UNBOUNDED } };
	for (int i = 1; i < argc;) {
		enum eco_code code = parse_one(argc, argv, &i, o, error);
		if (code)
			return code;
	}
	const char *missing = !o->load.url ? "the scene's URL" : !o->camera ? "--camera" : !o->load.clients ? "--clients"
		: !(o->load.seconds > 0) ? "--seconds" : NULL;
	return missing ? eco_fail(error, ECO_BAD_USAGE, "%s is missing; see ecoload --help", missing) : ECO_OK;
}

struct progress { struct view_progress bar; double seconds; };

static void on_tick(void *ctx, double gone)
{
	struct progress *p = ctx;
	view_progress_show(&p->bar, gone < p->seconds ? gone : p->seconds, p->seconds, "asking");
}

/* ---- Figures ---- */

static const struct { const char *name; double share; } quantiles[] = { { "p50", 0.5 }, { "p90", 0.9 }, { "p99", 0.99 }, { "max", 1 } };
#define QUANTILES (sizeof quantiles / sizeof quantiles[0])

static void print_times(const char *name, const struct view_times *times)
{
	printf("%-14s", name);
	for (size_t i = 0; i < QUANTILES; i++) {
		double ms = view_times_quantile(times, quantiles[i].share);
		isfinite(ms) ? printf("  %s %.1f", quantiles[i].name, ms) : printf("  %s -", quantiles[i].name);
	}
	puts(" ms");
}

static void print_text(const struct view_load_report *r)
{
	printf("requests        %llu in %.1f s: %.1f /s, %.2f MB/s\n", (unsigned long long)r->requests, r->seconds,
		(double)r->requests / r->seconds, (double)r->bytes / r->seconds / 1e6);
	print_times("latency", &r->latency);
	print_times("first byte", &r->first_byte);
	printf("chunks          %llu decoded, %llu sent twice; %llu answers without a picture\n", (unsigned long long)r->chunks,
		(unsigned long long)r->chunks_twice, (unsigned long long)r->nothing);
	printf("violations      vertices %llu, bytes %llu\n", (unsigned long long)r->vertex_violations,
		(unsigned long long)r->byte_violations);
	printf("failures       ");
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		printf(" %s %llu%s", view_load_failure_names[i], (unsigned long long)r->failures[i], i + 1 < VIEW_LOAD_FAILURES ? "," : "\n");
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

static json_t *count_json(uint64_t v)
{
	return json_integer((json_int_t)v);
}

static void print_json(const struct view_load_report *r, const struct options *options)
{
	json_t *o = json_object(), *failures = json_object();
	json_object_set_new(o, "clients", json_integer(options->load.clients));
	json_object_set_new(o, "seconds", json_real(r->seconds));
	json_object_set_new(o, "requests", count_json(r->requests));
	json_object_set_new(o, "requests_per_s", json_real((double)r->requests / r->seconds));
	json_object_set_new(o, "bytes", count_json(r->bytes));
	json_object_set_new(o, "bytes_per_s", json_real((double)r->bytes / r->seconds));
	json_object_set_new(o, "latency_ms", times_json(&r->latency));
	json_object_set_new(o, "first_byte_ms", times_json(&r->first_byte));
	json_object_set_new(o, "vertices", count_json(r->vertices));
	json_object_set_new(o, "chunks", count_json(r->chunks));
	json_object_set_new(o, "chunks_twice", count_json(r->chunks_twice));
	json_object_set_new(o, "nothing", count_json(r->nothing));
	json_object_set_new(o, "vertex_violations", count_json(r->vertex_violations));
	json_object_set_new(o, "byte_violations", count_json(r->byte_violations));
	for (int i = 0; i < VIEW_LOAD_FAILURES; i++)
		json_object_set_new(failures, view_load_failure_names[i], count_json(r->failures[i]));
	json_object_set_new(o, "failures", failures);
	json_object_set_new(o, "first_failure", r->first_failure[0] ? json_string(r->first_failure) : json_null());
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
			code = eco_fail(error, ECO_DAMAGED, "there were failures or violations, or no answer at all");
		view_load_free(&report);
	}
	eco_camera_free(camera);
	return code;
}

int main(int argc, char **argv)
{
	for (int i = 1; i < argc; i++) {
		if (!strcmp(argv[i], "--help"))
			return fputs(usage, stdout), view_output_status(0, "ecoload");
		if (!strcmp(argv[i], "--version"))
			return puts("ecostream 0.1"), view_output_status(0, "ecoload");
	}
	struct options options;
	struct eco_error error = { 0 };
	struct sigaction action = { .sa_handler = on_signal };
	action.sa_flags = (int)SA_RESETHAND;
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	enum eco_code code = parse(argc, argv, &options, &error);
	if (!code)
		code = view_fetch_setup(&error);
	if (!code)
		code = run(&options, &error);
	view_fetch_teardown();
	if (code)
		fprintf(stderr, "ecoload: %s\n", error.text);
	return view_output_status(eco_exit_status(code), "ecoload");
}
