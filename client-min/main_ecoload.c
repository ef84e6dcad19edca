/* ecoload: many clients at once, counting what a server does right and wrong, and how long it takes. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#include "client-min/load/view_load.h"
#include "client-min/view_exchange.h"
#include "client-min/view_report.h"
#include "ecofiles/base/options.h"
#include "ecofiles/base/progress.h"

#define SCORES_MAX 1000
#define PATIENCE_MS 10000

static void on_tick(void *ctx, double gone, uint64_t answers, uint64_t failures);

static struct options {
	struct view_load_options load;
	const char *csv;
	uint64_t scores;
	bool has_decode, json;
	uint32_t size[2];
	int arrivals;
} given = { .load = { .vertices = 1000000, .bytes = ECO_BYTES_UNBOUNDED, .seed = 1, .resumes = 1,
	.stop = &view_interrupted, .tick = on_tick },
	.size = { 800, 600 } };

static const char *const arrivals[] = { "even", "random", NULL };

static const struct eco_option option_table[] = {
	{ "the scene's URL", 0, ECO_OPTION_INPUT, "URL", .value = &given.load.url, .is_required = true },
	{ "camera", 0, ECO_OPTION_TEXT, "CAMERA", .value = &given.load.camera, .is_required = true },
	{ "clients", 0, ECO_OPTION_COUNT, "N", .value = &given.load.clients, 1, VIEW_CLIENTS_MAX,
		.is_required = true },
	{ "seconds", 0, ECO_OPTION_NUMBER, "S", .value = &given.load.seconds, 0.001, 1e6,
		.is_required = true },
	{ NULL, 0, ECO_OPTION_HEADING, .help = "Requests" },
	{ "vertices", 0, ECO_OPTION_COUNT, "N", .value = &given.load.vertices, 0, (double)ECO_VERTICES_MAX },
	{ "bytes", 0, ECO_OPTION_BYTES, "M", .value = &given.load.bytes, 0, (double)INT64_MAX },
	{ "size", 0, ECO_OPTION_SIZE, "WxH", .value = given.size, 1, ECO_IMAGE_MAX },
	{ "snap", 0, ECO_OPTION_NUMBER, "M", .value = &given.load.snap_m, 0.001, 1000 },
	{ "chunks", 0, ECO_OPTION_TEXT, "URL", .value = &given.load.chunks },
	{ "name-from", 0, ECO_OPTION_BYTES, "BYTES", .value = &given.load.name_from, 1, (double)INT64_MAX },
	{ NULL, 0, ECO_OPTION_HEADING, .help = "Times" },
	{ "rate", 0, ECO_OPTION_NUMBER, "R", .value = &given.load.rate, 0.001, 1e6 },
	{ "arrivals", 0, ECO_OPTION_CHOICE, "KIND", .value = &given.arrivals, .choices = arrivals },
	{ "deadline", 0, ECO_OPTION_NUMBER, "MS", .value = &given.load.deadline_ms, 1, 1e7 },
	{ NULL, 0, ECO_OPTION_HEADING, .help = "Clients" },
	{ "cold", 0, ECO_OPTION_COUNT, "N", .value = &given.load.cold, 0, VIEW_CLIENTS_MAX },
	{ "decode", 0, ECO_OPTION_COUNT, "N", .value = &given.load.decoding, 0, VIEW_CLIENTS_MAX,
		.given = &given.has_decode },
	{ "bandwidth", 0, ECO_OPTION_BYTES, "BYTES/S", .value = &given.load.bandwidth_bytes_s, 1,
		(double)INT64_MAX },
	{ "latency", 0, ECO_OPTION_NUMBER, "MS", .value = &given.load.latency_ms, 0, 60000 },
	{ "resume", 0, ECO_OPTION_COUNT, "N", .value = &given.load.resumes, 0, 100 },
	{ "seed", 0, ECO_OPTION_COUNT, "N", .value = &given.load.seed, 0, (double)INT64_MAX },
	{ NULL, 0, ECO_OPTION_HEADING, .help = "Report" },
	{ "score", 0, ECO_OPTION_COUNT, "N", .value = &given.scores, 0, SCORES_MAX },
	{ "json", 0, ECO_OPTION_FLAG, NULL, .value = &given.json },
	{ "csv", 0, ECO_OPTION_TEXT, "FILE", .value = &given.csv }, { 0 }
};

static const struct eco_command command = { .name = "ecoload", .options = option_table,
	.synopsis = "URL --camera CAMERA --clients N --seconds S [OPTIONS]",
	.says = "Loads a server with N clients; each starts at its own frame of a camera script. "
		"Times count from the moment a request is due, so an open loop includes waiting behind other "
		"requests. A client that gets 503 waits as long as Retry-After says. Ctrl-C ends the run and "
		"prints the report; a second Ctrl-C ends without one.",
	.notes = "A failed answer or one above its budget makes ecoload fail, too.\n" };

static void on_tick(void *ctx, double gone, uint64_t answers, uint64_t failures)
{
	char text[80];
	(void)ctx;
	snprintf(text, sizeof text, "%llu answers, %llu failures", (unsigned long long)answers,
		(unsigned long long)failures);
	eco_progress("loading", text, gone / given.load.seconds);
}

static void print_json(const struct view_load_report *result)
{
	json_t *json = view_load_json(result);
	json_dumpf(json, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
	putchar('\n');
	json_decref(json);
}

static enum eco_code report(struct options *o, struct view_load_report *result, struct view_fetch *fetch,
	struct eco_error *error)
{
	enum eco_code code = view_score_sample(result, fetch, (uint32_t)o->scores, error);
	if (code == ECO_INTERRUPTED)
		code = ECO_OK;
	if (code)
		return code;
	if (o->json)
		print_json(result);
	else
		view_load_print(result, stdout);
	if (o->csv)
		code = view_load_csv(result, o->csv, error);
	if (!code && !view_load_clean(result))
		code = eco_fail(error, ECO_DAMAGED, "there were failures or violations, or no answer at all");
	return code;
}

static enum eco_code run(struct options *o, struct eco_error *error)
{
	struct view_fetch_options at = { .url = o->load.url, .patience_ms = PATIENCE_MS,
		.stop = &view_interrupted };
	struct view_fetch *fetch = NULL;
	struct view_load_report result;
	eco_progress_begin("ecoload");
	enum eco_code code = view_fetch_new(&fetch, &at, error);
	if (!code)
		code = view_views_make(&o->load, fetch, error);
	if (!code) {
		code = view_load_run(&result, &o->load, error);
		eco_progress_end();
		if (!code) {
			view_interrupted = 0;             /* what there is is reported; the next signal kills */
			code = report(o, &result, fetch, error);
			view_load_free(&result);
		}
	}
	free(o->load.views);
	view_fetch_free(fetch);
	return code;
}

static enum eco_code read_line(int argc, char **argv, struct options *o, struct eco_error *error)
{
	enum eco_code code = eco_command_read(&command, argc - 1, argv + 1, error);
	struct view_load_options *load = &o->load;
	if (!o->has_decode)
		load->decoding = load->clients < 16 ? load->clients : 16;
	load->random_arrivals = o->arrivals == 1;
	load->width = o->size[0];
	load->height = o->size[1];
	if (code)
		return code;
	if (load->cold > load->clients || load->decoding > load->clients)
		return eco_fail(error, ECO_BAD_USAGE, "--%s: there are %llu clients", load->cold > load->clients
			? "cold" : "decode", (unsigned long long)load->clients);
	if (o->arrivals && !(load->rate > 0))
		return eco_fail(error, ECO_BAD_USAGE, "--arrivals: only with --rate");
	if (load->name_from && !load->chunks)
		return eco_fail(error, ECO_BAD_USAGE, "--name-from: only with --chunks");
	return load->chunks ? view_exchange_check_chunks(load->chunks, error) : ECO_OK;
}

/* A client has a descriptor for each of its connections. */
static void allow_descriptors(void)
{
	struct rlimit limit;
	if (!getrlimit(RLIMIT_NOFILE, &limit)) {
		limit.rlim_cur = limit.rlim_max;
		setrlimit(RLIMIT_NOFILE, &limit);
	}
}

int main(int argc, char **argv)
{
	struct eco_error error = { 0 };
	if (eco_command_answers(&command, argc - 1, argv + 1))
		return eco_command_end(&command, ECO_OK, &error);
	view_catch_signals();
	signal(SIGPIPE, SIG_IGN);
	allow_descriptors();
	enum eco_code code = read_line(argc, argv, &given, &error);
	if (!code)
		code = view_fetch_setup(&error);
	if (!code)
		code = run(&given, &error);
	view_fetch_teardown();
	return eco_command_end(&command, code, &error);
}
