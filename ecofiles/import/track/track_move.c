/* A flight put where the scene is. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/track/track.h"

#define DEG 57.29577951308232

double eco_distance(const double a[3], const double b[3])
{
	return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) + (b[2] - a[2]) * (b[2] - a[2]));
}

double eco_angle_deg(const double a[3], const double b[3])
{
	double cross[3] = { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
	return atan2(sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * DEG;
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

static enum eco_code cut(struct eco_flight *f, const struct eco_flight_move *m, struct eco_error *error)
{
	double last_s = (f->count - 1) * f->step_s, from_s = isnan(m->from_s) ? 0 : m->from_s, to_s = isnan(m->to_s) ? last_s : fmin(m->to_s, last_s);
	if (!(from_s <= to_s))
		return eco_fail(error, ECO_BAD_INPUT, "nothing is left from %g s to %g s: the track lasts %.6g s", from_s, isnan(m->to_s) ? last_s : m->to_s,
			last_s);
	uint32_t first = (uint32_t)(from_s / f->step_s + 0.5), end = (uint32_t)(to_s / f->step_s + 0.5) + 1;
	memmove(f->samples, f->samples + first, (end - first) * sizeof *f->samples);
	f->count = end - first;
	return ECO_OK;
}

static void turn(double v[2], double sine, double cosine)
{
	double x = v[0];
	v[0] = cosine * x - sine * v[1];
	v[1] = sine * x + cosine * v[1];
}

/* Turned and scaled about the first eye or the centre, which then goes to `to`. */
static void place(struct eco_flight *f, const struct eco_flight_move *m)
{
	double low[3], high[3], pivot[3], to[3], scale = m->scale > 0 ? m->scale : 1, sine = sin(m->turn_deg / DEG), cosine = cos(m->turn_deg / DEG);
	eco_flight_box(f, low, high);
	for (int k = 0; k < 3; k++) {
		pivot[k] = m->centre ? (low[k] + high[k]) / 2 : f->samples[0].eye[k];
		to[k] = m->to_given && !isnan(m->to[k]) ? m->to[k] : pivot[k];
	}
	/* heights above the ground are no heights to be moved */
	if (m->from_ground)
		pivot[2] = to[2] = 0;
	for (struct eco_sample *s = f->samples; s < f->samples + f->count; s++) {
		for (int k = 0; k < 3; k++)
			s->eye[k] = scale * (s->eye[k] - pivot[k]);
		turn(s->eye, sine, cosine);
		turn(s->look, sine, cosine);
		turn(s->up, sine, cosine);
		for (int k = 0; k < 3; k++)
			s->eye[k] += to[k];
	}
	f->length_m *= scale;
}

static void stand(struct eco_flight *f, const struct eco_flight_move *m, struct eco_flight_moved *moved)
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
			s->up[k] = flat > 1e-6 ? ((k == 2) - s->look[2] * s->look[k]) / flat : i ? before->up[k] : k == 1;
	}
}

enum eco_code eco_flight_move(struct eco_flight *flight, const struct eco_flight_move *move, struct eco_flight_moved *moved, struct eco_error *error)
{
	*moved = (struct eco_flight_moved){ 0 };
	enum eco_code code = isnan(move->from_s) && isnan(move->to_s) ? ECO_OK : cut(flight, move, error);
	if (code)
		return code;
	place(flight, move);
	stand(flight, move, moved);
	if (move->look_at_given)
		look_at(flight, move->look_at);
	flight->step_s /= move->speed > 0 ? move->speed : 1;
	return ECO_OK;
}
