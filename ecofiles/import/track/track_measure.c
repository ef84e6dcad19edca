/* Distances, angles and speeds, of fixes and of flights; a flight's end. */
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
