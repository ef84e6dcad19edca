/* Distances, angles and speeds, of fixes and of flights; a flight put where the scene is. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

#define WINDOW_S 1.0                     /* speeds are measured over */

double eco_distance(const double a[3], const double b[3])
{
	return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])
		+ (b[2] - a[2]) * (b[2] - a[2]));
}

double eco_angle_deg(const double a[3], const double b[3])
{
	double cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
	return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]),
		a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * TRACK_DEG;
}

void track_axes(double yaw_deg, double pitch_deg, double roll_deg, double look[3], double up[3])
{
	double yaw = yaw_deg / TRACK_DEG, pitch = pitch_deg / TRACK_DEG, roll = roll_deg / TRACK_DEG;
	double sy = sin(yaw), cy = cos(yaw), sp = sin(pitch), cp = cos(pitch);
	const double ahead[3] = { cp * sy, cp * cy, sp }, right[3] = { cy, -sy, 0 };
	const double level[3] = { -sp * sy, -sp * cy, cp };
	for (int k = 0; k < 3; k++) {
		look[k] = ahead[k];
		up[k] = cos(roll) * level[k] + sin(roll) * right[k];
	}
}

void eco_flight_box(const struct eco_flight *f, double low[3], double high[3])
{
	memcpy(low, f->samples[0].eye, 3 * sizeof *low);
	memcpy(high, low, 3 * sizeof *high);
	for (uint32_t i = 0; i < 3 * f->count; i++) {
		low[i % 3] = fmin(low[i % 3], f->samples[i / 3].eye[i % 3]);
		high[i % 3] = fmax(high[i % 3], f->samples[i / 3].eye[i % 3]);
	}
}

double track_distance(const struct eco_fix *a, const struct eco_fix *b)
{
	double dz = b->at[2] - a->at[2], flat = hypot(b->at[0] - a->at[0], b->at[1] - a->at[1]);
	return isnan(dz) ? flat : hypot(flat, dz);
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double track_quantile(double *values, uint32_t count, double share)
{
	if (count)
		qsort(values, count, sizeof *values, by_value);
	return count ? values[(uint32_t)(share * (count - 1))] : 0;
}

uint32_t track_speeds(const struct eco_track *track, double *speeds)
{
	const struct eco_fix *f = track->fixes, *last = NULL;
	uint32_t count = 0, still = 0;
	double window_s = track->count ? fmin(WINDOW_S, (f[track->count - 1].time_s - f[0].time_s) / 8) : 0;
	for (uint32_t i = 0; i < track->count; i++) {
		double took_s = last ? f[i].time_s - last->time_s : window_s;
		if (isnan(f[i].at[0]) || isnan(f[i].time_s) || !(took_s >= window_s))
			continue;
		double d = last ? track_distance(last, &f[i]) : 0;
		if (d > 0)
			speeds[count++] = d / fmax(took_s, 1e-9);
		last = &f[i];
	}
	/* a slow drift is no motion either */
	for (double high = track_quantile(speeds, count, 0.9); still < count && speeds[still] < 0.1 * high; )
		still++;
	memmove(speeds, speeds + still, (count - still) * sizeof *speeds);
	return count - still;
}

void eco_flight_free(struct eco_flight *flight)
{
	free(flight->samples);
	*flight = (struct eco_flight){ 0 };
}

/* Turned about the first eye, which then goes to `to`. Heights that count from the ground stay. */
static void place(struct eco_flight *f, const struct eco_track *track, const struct eco_track_options *m)
{
	double first[3], to[3], ground = 0;
	double sine = sin(m->turn_deg / TRACK_DEG), cosine = cos(m->turn_deg / TRACK_DEG);
	bool relative = track->height == ECO_HEIGHTS_RELATIVE, goes = m->to_given || track->local;
	bool stays = (m->has_ground && !track->has_height) || (track->local && relative);
	for (int k = 0; k < 3; k++) {
		first[k] = f->samples[0].eye[k];
		to[k] = goes && !(k == 2 && stays) ? m->to[k] : first[k];
	}
	if (!m->to_given && relative && m->ground) {
		eco_ground_height(m->ground, first[0], first[1], &ground);
		to[2] += ground;
	}
	for (struct eco_sample *s = f->samples; s < f->samples + f->count; s++) {
		for (int k = 0; k < 3; k++)
			s->eye[k] -= first[k];
		for (double *v = s->n; v < s->n + 9; v += 3) {       /* eye, look, up */
			double x = v[0];
			v[0] = cosine * x - sine * v[1];
			v[1] = sine * x + cosine * v[1];
		}
		for (int k = 0; k < 3; k++)
			s->eye[k] += to[k];
	}
}

static void stand(struct eco_flight *f, const struct eco_track *track, const struct eco_track_options *m)
{
	double low[3], high[3];
	eco_flight_box(f, low, high);
	/* without a scene the ground is unknown: take it as z = 0, and keep the whole track above */
	double lift = track->local && !m->has_ground ? fmax(0, m->clearance_m - low[2]) : 0;
	for (uint32_t i = 0; i < f->count; i++) {
		double *eye = f->samples[i].eye, ground = 0;
		f->off_ground += m->ground && !eco_ground_height(m->ground, eye[0], eye[1], &ground);
		eye[2] += m->has_ground && !track->has_height ? ground : lift;
		double lacks = m->has_ground ? ground + m->clearance_m - eye[2] : 0;
		f->raised += lacks > 0;
		f->raised_m = fmax(f->raised_m, lacks);
		eye[2] += fmax(lacks, 0);
	}
}

/* At the point itself it looks on as before. */
static void look_at(struct eco_flight *f, const double at[3])
{
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		const double x = at[0] - s->eye[0], y = at[1] - s->eye[1], z = at[2] - s->eye[2];
		track_axes(atan2(x, y) * TRACK_DEG, atan2(z, hypot(x, y)) * TRACK_DEG, 0, s->look, s->up);
		if (i && eco_distance(s->eye, at) < 1e-6)
			memcpy(s->n + 3, s[-1].n + 3, 6 * sizeof *s->n);
	}
}

void eco_flight_move(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options)
{
	place(flight, track, options);
	stand(flight, track, options);
	if (options->look_at_given)
		look_at(flight, options->look_at);
	flight->step_s /= options->speed > 0 ? options->speed : 1;
}
