/* What views expect of budgets of bytes, by the planner's own figures: no picture is drawn, so that many can
 * be asked for.
 *
 *   budgets [--seed S] [--vertices V] [--times N] [--each] VIEWS PACK...
 *
 * For each view of a scene, from the ground up to above it, an answer without a budget of bytes and one for
 * each budget; with --times a plan takes N times the work of a typical one at most, as a server's. A line a
 * pack:
 *
 *   used     bytes of the answer over the budget, where it binds, the mean and the least
 *   worse    rows that expect more than 2 % more wrong pixels (struct lod_planner_stats.wrong) than one of the
 *            same view with fewer bytes; the worst ratio
 *   q        the same of Q: rows that predict more than .005 less; the worst fall
 *   cut      wrong pixels of the answer without a budget, cut after so many bytes, over those asked for:
 *            share of the rows within 1.10, geometric mean, worst
 *   work     of the plan with both budgets over that of the plan for vertices alone: mean, worst; the
 *            same of processor time
 *   mean     geometric mean of the wrong pixels over all budgets, to compare two builds; and the mean of
 *            the bytes of answers without a budget */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/typical.h"
#include "tests/support/serve/random_request.h"

#define WORSE 1.02
#define Q_LESS 0.005
#define NEAR 1.1
#define WRONG_LEAST 24.0         /* pixels of 480,000: fewer are none */

static const uint64_t budgets[] = { 10000, 20000, 40000, 70000, 100000, 150000, 300000, 600000, 1000000,
	2000000, 5000000, 10000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

struct run { uint64_t seed, views, vertices, times, work_max; bool each; };
struct sums {
	uint32_t binding, worse, less, cuts, near;
	double used, used_least, worst, fall, cut_logs, cut_worst, work, work_worst, ms, ms_worst, logs;
	uint32_t rows, looked;
	double all_bytes;
};
struct answer { double wrong, q, work, ms; uint64_t bytes; bool fits; };

static double processor_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static struct srv_stream plan_answer(const struct srv_scene *scene, const struct eco_view *view,
	const struct run *run, uint64_t bytes, struct answer *answer)
{
	const struct eco_request request = { .view = *view, .vertices = run->vertices, .bytes = bytes };
	struct srv_stream stream;
	struct eco_error error = { 0 };
	double begun = processor_ms();
	if (srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene, .request = &request,
			.work_max = run->work_max }, &error))
		random_stop("planning", &error);
	const struct srv_step *last = &stream.steps[stream.step_count - 1];
	*answer = (struct answer){ fmax(WRONG_LEAST, last->wrong), eco_predicted_q(&last->plan.prediction),
		(double)stream.work, processor_ms() - begun, stream.body_bytes, stream.fits };
	return stream;
}

/* Wrong pixels after so many bytes: of the last step that is whole by then. */
static double wrong_after(const struct srv_stream *stream, uint64_t bytes)
{
	double wrong = NAN;
	for (uint32_t i = 0; i < stream->step_count; i++)
		if (stream->steps[i].end_bytes <= bytes)
			wrong = fmax(WRONG_LEAST, stream->steps[i].wrong);
	return wrong;
}

static void add_row(struct sums *s, const struct answer *now, const struct answer *all, uint64_t budget,
	double cut, double least, double most_q)
{
	bool worse = now->wrong > WORSE * least;
	s->rows++;
	s->worse += worse;
	s->worst = fmax(s->worst, now->wrong / least);
	s->less += now->q < most_q - Q_LESS;
	s->fall = fmax(s->fall, most_q - now->q);
	if (all->bytes <= budget)
		return;
	double used = (double)now->bytes / (double)budget, work = now->work / all->work, ms = now->ms / all->ms;
	s->binding++;
	s->used += used;
	s->used_least = fmin(s->used_least, used);
	s->work += work;
	s->work_worst = fmax(s->work_worst, work);
	s->ms += ms;
	s->ms_worst = fmax(s->ms_worst, ms);
	if (isnan(cut) || budget < 20000)
		return;
	s->cuts++;
	s->near += cut / now->wrong <= NEAR;
	s->cut_logs += log(cut / now->wrong);
	s->cut_worst = fmax(s->cut_worst, cut / now->wrong);
}

static void one_view(const struct srv_scene *scene, uint64_t number, const struct run *run, struct sums *s)
{
	struct eco_view view = random_outlook(&scene->pack->scene, run->seed, number);
	struct answer all, now;
	struct srv_stream whole = plan_answer(scene, &view, run, ECO_BYTES_UNBOUNDED, &all);
	double least = INFINITY, most_q = 0;
	s->all_bytes += (double)all.bytes;
	for (size_t b = 0; b < BUDGETS; b++) {
		if (all.bytes <= budgets[b] && b && all.bytes <= budgets[b - 1]) {       /* the same again */
			s->logs += log(all.wrong);
			s->looked++;
			continue;
		}
		struct srv_stream stream = plan_answer(scene, &view, run, budgets[b], &now);
		double cut = wrong_after(&whole, budgets[b]);
		if (!now.fits) {
			srv_stream_free(&stream);
			continue;
		}
		least = fmin(least, now.wrong);
		most_q = fmax(most_q, now.q);
		add_row(s, &now, &all, budgets[b], cut, least, most_q);
		if (run->each)
			printf("view %llu, %llu bytes: %llu of %llu, wrong %.0f%s, cut %.0f, q %.4f%s, "
				"work x%.2f, %.1f ms x%.2f\n", (unsigned long long)number,
				(unsigned long long)budgets[b], (unsigned long long)now.bytes,
				(unsigned long long)all.bytes, now.wrong, now.wrong > WORSE * least ? " WORSE"
				: "", cut, now.q, now.q < most_q - Q_LESS ? " LESS" : "", now.work / all.work,
				now.ms, now.ms / all.ms);
		srv_stream_free(&stream);
		s->logs += log(now.wrong);
		s->looked++;
	}
	srv_stream_free(&whole);
}

static void run_pack(const char *path, struct run *run)
{
	struct srv_store scenes;
	struct eco_error error = { 0 };
	struct sums s = { .used_least = 1 };
	const char *slash = strrchr(path, '/');
	srv_store_init(&scenes);
	if (srv_store_add(&scenes, "scene", path, &error))
		random_stop(path, &error);
	run->work_max = run->times * srv_typical_work(scenes.scenes[0]);
	for (uint64_t number = 0; number < run->views; number++)
		one_view(scenes.scenes[0], number, run, &s);
	double n = s.binding ? s.binding : 1, cuts = s.cuts ? s.cuts : 1;
	printf("%s: %u rows, %u bind; used %.3f, least %.3f; worse %u, %.3f; q %u, %.4f; "
		"cut %.2f of %u, %.3f, %.2f; work %.2f, %.2f; ms %.2f, %.2f; mean %.1f, %.0f kB\n",
		slash ? slash + 1 : path, s.rows, s.binding, s.used / n, s.used_least, s.worse, s.worst, s.less, s.fall, s.near / cuts, s.cuts,
		exp(s.cut_logs / cuts), s.cut_worst, s.work / n, s.work_worst, s.ms / n, s.ms_worst,
		exp(s.logs / s.looked), s.all_bytes / (double)run->views / 1e3);
	fflush(stdout);
	srv_store_free(&scenes);
}

int main(int argc, char **argv)
{
	static const struct option options[] = { { "each", no_argument, NULL, 'e' },
		{ "seed", required_argument, NULL, 's' }, { "vertices", required_argument, NULL, 'v' },
		{ "times", required_argument, NULL, 't' },
		{ NULL, 0, NULL, 0 } };
	struct run run = { .seed = 1, .vertices = 1000000 };
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;) {
		uint64_t value = optarg ? strtoull(optarg, NULL, 10) : 0;
		usable = usable && c != '?';
		run.each = run.each || c == 'e';
		run.seed = c == 's' ? value : run.seed;
		run.vertices = c == 'v' ? value : run.vertices;
		run.times = c == 't' ? value : run.times;
	}
	run.views = argc - optind >= 2 ? strtoull(argv[optind], NULL, 10) : 0;
	if (!usable || !run.views || run.vertices > ECO_VERTICES_MAX) {
		fputs("usage: budgets [--seed S] [--vertices V] [--times N] [--each] VIEWS PACK...\n",
			stderr);
		return 2;
	}
	for (int i = optind + 1; i < argc; i++)
		run_pack(argv[i], &run);
	return 0;
}
