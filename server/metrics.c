#include "server/metrics.h"

#include <stdio.h>

#define PREFIX "ecoserve_"

static const struct { const char *metric, *help; } counter_rows[] = {
#define X(name, metric, help) { metric, help },
	SRV_COUNTERS(X)
#undef X
};

/* Those that there are; any other counts as the last. */
static const unsigned statuses[] = { 200, 204, 206, 304, 400, 401, 403, 404, 405, 409, 411, 412, 413, 414,
	415, 416, 422, 500, 503, 0 };
#define STATUS_COUNT (sizeof statuses / sizeof *statuses)
_Static_assert(STATUS_COUNT <= SRV_STATUSES_MAX, "room for all statuses");

static const double buckets_s[SRV_PLAN_BUCKETS] = { 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10 };

void srv_count_request(struct srv_metrics *metrics, const struct srv_route *route, unsigned status)
{
	size_t i = 0;
	while (statuses[i] && statuses[i] != status)
		i++;
	atomic_fetch_add_explicit(&metrics->requests[route ? route - srv_routes : SRV_RESOURCE_COUNT][i], 1,
		memory_order_relaxed);
}

void srv_count_plan(struct srv_metrics *metrics, uint64_t took_us, uint64_t work, bool cut_short)
{
	uint32_t i = 0;
	while (i < SRV_PLAN_BUCKETS && (double)took_us * 1e-6 > buckets_s[i])
		i++;
	atomic_fetch_add_explicit(&metrics->plan_buckets[i], 1, memory_order_relaxed);
	atomic_fetch_add_explicit(&metrics->plan_us, took_us, memory_order_relaxed);
	srv_count(metrics, SRV_COUNT_PLANS, 1);
	srv_count(metrics, SRV_COUNT_PLANS_CUT, cut_short);
	srv_count(metrics, SRV_COUNT_PLAN_WORK, work);
}

/* ---- Text ---- */

static void add_head(struct eco_writer *out, const char *metric, const char *type, const char *help)
{
	eco_write_format(out, "# HELP " PREFIX "%s %s\n# TYPE " PREFIX "%s %s\n", metric, help, metric, type);
}

static void add_value(struct eco_writer *out, const char *metric, const char *type, const char *help,
	uint64_t value)
{
	add_head(out, metric, type, help);
	eco_write_format(out, PREFIX "%s %llu\n", metric, (unsigned long long)value);
}

static void add_requests(struct eco_writer *out, struct srv_metrics *metrics)
{
	add_head(out, "requests_total", "counter", "Requests that were answered, by route and status.");
	for (uint32_t r = 0; r <= SRV_RESOURCE_COUNT; r++)
		for (size_t s = 0; s < STATUS_COUNT; s++) {
			uint64_t count = atomic_load(&metrics->requests[r][s]);
			if (count)
				eco_write_format(out,
					PREFIX "requests_total{route=\"%s\",code=\"%u\"} %llu\n",
					r < SRV_RESOURCE_COUNT ? srv_routes[r].pattern : "", statuses[s],
					(unsigned long long)count);
		}
}

static void add_plans(struct eco_writer *out, struct srv_metrics *metrics)
{
	uint64_t sum = 0;
	add_head(out, "plan_seconds", "histogram",
		"How long plans took, from their start on a thread to their "
		"answer.");
	for (uint32_t i = 0; i <= SRV_PLAN_BUCKETS; i++) {
		sum += atomic_load(&metrics->plan_buckets[i]);
		if (i < SRV_PLAN_BUCKETS)
			eco_write_format(out, PREFIX "plan_seconds_bucket{le=\"%g\"} %llu\n", buckets_s[i],
				(unsigned long long)sum);
	}
	eco_write_format(out, PREFIX "plan_seconds_bucket{le=\"+Inf\"} %llu\n", (unsigned long long)sum);
	eco_write_format(out, PREFIX "plan_seconds_sum %.6f\n" PREFIX "plan_seconds_count %llu\n",
		(double)atomic_load(&metrics->plan_us) * 1e-6, (unsigned long long)sum);
}

void srv_metrics_write(struct eco_writer *out, struct srv_metrics *metrics, const struct srv_gauges *gauges)
{
	for (uint32_t i = 0; i < SRV_COUNTER_COUNT; i++)
		add_value(out, counter_rows[i].metric, "counter", counter_rows[i].help,
			atomic_load(&metrics->counters[i]));
	add_requests(out, metrics);
	add_plans(out, metrics);
#define X(name, metric, type, help) add_value(out, metric, type, help, gauges->name);
	SRV_GAUGES(X)
#undef X
}
