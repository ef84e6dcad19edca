/* A flight put where the scene is. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/track/track.h"

#define DEG 57.29577951308232

static void sub(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

static enum eco_code cut(struct eco_flight *f, const struct eco_flight_move *m, struct eco_error *error)
{
	double last_s = (f->count - 1) * f->step_s, from_s = isnan(m->from_s) ? 0 : m->from_s, to_s = isnan(m->to_s) ? last_s : fmin(m->to_s, last_s);
	if (isnan(m->from_s) && isnan(m->to_s))
		return ECO_OK;
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

/* Turned and scaled about `pivot`, which then goes to `to`. */
static void place(struct eco_flight *f, const struct eco_flight_move *m)
{
	double low[3], high[3], pivot[3], to[3], scale = m->scale > 0 ? m->scale : 1, sine = sin(m->turn_deg / DEG), cosine = cos(m->turn_deg / DEG);
	memcpy(low, f->samples[0].eye, sizeof low);
	memcpy(high, low, sizeof high);
	for (uint32_t i = 0; i < f->count; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], f->samples[i].eye[k]);
			high[k] = fmax(high[k], f->samples[i].eye[k]);
		}
	for (int k = 0; k < 3; k++) {
		pivot[k] = m->centre ? (low[k] + high[k]) / 2 : f->samples[0].eye[k];
		to[k] = m->to_given && !isnan(m->to[k]) ? m->to[k] : pivot[k];
	}
	/* heights above the ground are no heights to be moved */
	if (m->from_ground)
		pivot[2] = to[2] = 0;
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		double from[3];
		sub(s->eye, pivot, from);
		turn(from, sine, cosine);
		turn(s->look, sine, cosine);
		turn(s->up, sine, cosine);
		for (int k = 0; k < 3; k++)
			s->eye[k] = to[k] + scale * from[k];
	}
	f->length_m *= scale;
}

static void stand(struct eco_flight *f, const struct eco_flight_move *m, struct eco_flight_moved *moved)
{
	for (uint32_t i = 0; i < f->count && m->has_ground; i++) {
		double *eye = f->samples[i].eye, ground = 0;
		if (m->ground)
			moved->off_ground += !eco_ground_height(m->ground, eye[0], eye[1], &ground);
		if (m->from_ground)
			eye[2] += ground;
		double lacks = ground + m->clearance_m - eye[2];
		if (lacks > 0) {
			eye[2] += lacks;
			moved->raised++;
			moved->raised_m = fmax(moved->raised_m, lacks);
		}
	}
}

static void look_at(struct eco_flight *f, const double at[3])
{
	for (uint32_t i = 0; i < f->count; i++) {
		struct eco_sample *s = &f->samples[i];
		double look[3], dot, length;
		sub(at, s->eye, look);
		length = sqrt(look[0] * look[0] + look[1] * look[1] + look[2] * look[2]);
		/* at the point itself it looks on as before */
		if (length < 1e-6)
			memcpy(look, i ? s[-1].look : s->look, sizeof look);
		else
			for (int k = 0; k < 3; k++)
				look[k] /= length;
		memcpy(s->look, look, sizeof look);
		dot = look[2];
		double up[3] = { -dot * look[0], -dot * look[1], 1 - dot * dot }, size = sqrt(fmax(0, 1 - dot * dot));
		for (int k = 0; k < 3; k++)
			s->up[k] = size > 1e-6 ? up[k] / size : i ? s[-1].up[k] : k == 1;
	}
}

enum eco_code eco_flight_move(struct eco_flight *flight, const struct eco_flight_move *move, struct eco_flight_moved *moved, struct eco_error *error)
{
	*moved = (struct eco_flight_moved){ 0 };
	enum eco_code code = cut(flight, move, error);
	if (code)
		return code;
	place(flight, move);
	stand(flight, move, moved);
	if (move->look_at_given)
		look_at(flight, move->look_at);
	if (move->speed > 0)
		flight->step_s /= move->speed;
	return ECO_OK;
}
