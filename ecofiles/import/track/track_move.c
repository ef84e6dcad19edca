/* A flight put where the scene is. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

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

void eco_flight_box(const struct eco_flight *f, double low[3], double high[3])
{
	memcpy(low, f->samples[0].eye, 3 * sizeof *low);
	memcpy(high, low, 3 * sizeof *high);
	for (uint32_t i = 0; i < 3 * f->count; i++) {
		low[i % 3] = fmin(low[i % 3], f->samples[i / 3].eye[i % 3]);
		high[i % 3] = fmax(high[i % 3], f->samples[i / 3].eye[i % 3]);
	}
}

static void turn(double v[2], double sine, double cosine)
{
	double x = v[0];
	v[0] = cosine * x - sine * v[1];
	v[1] = sine * x + cosine * v[1];
}

/* Turned about the first eye, which then goes to `to`. Heights above the ground are no heights to be moved.
 */
static void place(struct eco_flight *f, const struct eco_track_options *m)
{
	double first[3], to[3], sine = sin(m->turn_deg / TRACK_DEG), cosine = cos(m->turn_deg / TRACK_DEG);
	for (int k = 0; k < 3; k++) {
		first[k] = f->samples[0].eye[k];
		to[k] = m->to_given && !isnan(m->to[k]) && !(k == 2 && m->from_ground) ? m->to[k] : first[k];
	}
	for (struct eco_sample *s = f->samples; s < f->samples + f->count; s++) {
		for (int k = 0; k < 3; k++)
			s->eye[k] -= first[k];
		turn(s->eye, sine, cosine);
		turn(s->look, sine, cosine);
		turn(s->up, sine, cosine);
		for (int k = 0; k < 3; k++)
			s->eye[k] += to[k];
	}
}

static void stand(struct eco_flight *f, const struct eco_track_options *m, struct eco_flight_moved *moved)
{
	for (uint32_t i = 0; i < f->count && m->has_ground; i++) {
		double *eye = f->samples[i].eye, ground = 0;
		moved->off_ground += m->ground && !eco_ground_height(m->ground, eye[0], eye[1], &ground);
		eye[2] += m->from_ground ? ground : 0;
		double lacks = ground + m->clearance_m - eye[2];
		moved->raised += lacks > 0;
		moved->raised_m = fmax(moved->raised_m, lacks);
		eye[2] += fmax(lacks, 0);
	}
}

/* At the point itself it looks on as before. */
static void look_at(struct eco_flight *f, const double at[3])
{
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i], *before = i ? s - 1 : s;
		double length = eco_distance(s->eye, at);
		for (int k = 0; k < 3; k++)
			s->look[k] = length < 1e-6 ? before->look[k] : (at[k] - s->eye[k]) / length;
		double flat = sqrt(fmax(0, 1 - s->look[2] * s->look[2]));
		for (int k = 0; k < 3; k++)
			s->up[k] = flat > 1e-6 ? ((k == 2) - s->look[2] * s->look[k]) / flat : i
				? before->up[k] : k == 1;
	}
}

void eco_flight_move(struct eco_flight *flight, const struct eco_track_options *options,
	struct eco_flight_moved *moved)
{
	*moved = (struct eco_flight_moved){ 0 };
	place(flight, options);
	stand(flight, options, moved);
	if (options->look_at_given)
		look_at(flight, options->look_at);
	flight->step_s /= options->speed > 0 ? options->speed : 1;
}
