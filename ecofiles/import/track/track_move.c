/* A flight put where the scene is. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/track/track_read.h"

static void turn(double v[2], double sine, double cosine)
{
	double x = v[0];
	v[0] = cosine * x - sine * v[1];
	v[1] = sine * x + cosine * v[1];
}

/* Turned about the first eye, which then goes to `to`. Heights above the ground are not moved. */
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

void eco_flight_lift(struct eco_flight *flight, double by_m)
{
	for (uint32_t i = 0; i < flight->count; i++)
		flight->samples[i].eye[2] += by_m;
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
