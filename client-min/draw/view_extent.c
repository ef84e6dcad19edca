#include "client-min/draw/view_extent.h"

#include <math.h>

#include "lod/scattered.h"

double view_extent_balls_px(const struct view_gl_job *job, const uint32_t size[2],
	const struct lod_impostor *impostor, const uint32_t *members, uint32_t count)
{
	const struct lod_eye *eye = job->eye;
	const double *axes[2] = { eye->right, eye->up },
		focal[2] = { size[0] / eye->tan_x, size[1] / eye->tan_y };
	double widest = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_place *place = &job->selection->instances[members[i]].place;
		double r = impostor->radius * place->scale, center[3];
		lod_place_point(place, impostor->body.center, center);
		for (int k = 0; k < 3; k++)
			center[k] -= eye->at[k];
		double far = lod_dot(center, eye->forward);
		for (int k = 0; k < 2 && far > r; k++) {
			double aside = lod_dot(center, axes[k]);
			widest = fmax(widest, focal[k] * r * sqrt(aside * aside + far * far - r * r)
				/ (far * far - r * r));
		}
	}
	return widest;
}

double view_extent_ellipses(const struct view_gl_job *job, const struct view_gpu_list *g,
	const struct view_list *list, const struct eco_cut *cut, const uint32_t *members, uint32_t count)
{
	const struct lod_eye *eye = job->eye;
	bool splats = list->list.attributes & ECO_ATTR_SPLAT;
	double ball = lod_ball_radius(&list->list, cut->scale), radius = cut->halvings ? 2 * ball : 0;
	double reach = (double)g->reach * (splats ? sqrt((double)cut->scale) : ball), most = 0;
	float middle[3], half[3];
	for (int k = 0; k < 3; k++) {
		middle[k] = 0.5f * (g->low[k] + g->high[k]);
		half[k] = 0.5f * (g->high[k] - g->low[k]);
	}
	radius += sqrt((double)(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]));
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_place *place = &job->selection->instances[members[i]].place;
		double at[3], far = -radius * place->scale;
		lod_place_point(place, middle, at);
		for (int k = 0; k < 3; k++)
			far += (at[k] - eye->at[k]) * eye->forward[k];
		if (!(far > 2 * reach * place->scale))
			return INFINITY;
		most = fmax(most, reach * place->scale / far);
	}
	return most;
}
