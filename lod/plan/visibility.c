/* Visibilities on the coarse screen: see lod/plan/visibility.h. */
#include "lod/plan/visibility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/lanes.h"

#define PI 3.14159265358979323846
#define AROUND 2.5               /* false positives of a plant lie in a box so much wider and higher than its
                                  * own */
#define SEEN_LEAST 1e-4          /* share seen of what is hidden or outside the picture: it may be seen
                                  * through an unknown gap */
#define HILL 1.0f                /* columns on either side of a foot in which ground hides */
#define TRUNK 0.1                /* of a crown's half extent across: wood is no nearer than this */
#define CLEAR_LEAST 1e-6f        /* light through the own crown below which that of others is not told */
#define DENSEST 0.66666666666666667 /* of a denser crown: it covers as much of a larger ellipse, so that false
                                     * positives lie around it */
#define BOX 0.88622692545275801  /* half the side of a square as large as a circle of radius 1 */

/* ---- Numbers ---- */

/* 2^exponent, for those of numbers that have all their bits. */
static double power_of_2(int exponent)
{
	uint64_t bits = (uint64_t)(exponent + 1023) << 52;
	double power;
	memcpy(&power, &bits, sizeof power);
	return power;
}

double lod_exp_minus(double x)
{
	if (!(x < 700))
		return 0;
	int turns = (int)(x * 1.4426950408889634 + 0.5);
	double r = turns * 0.69314718055994531 - x, r2 = r * r, r4 = r2 * r2;
	double low = 1 + r + r2 * (1.0 / 2 + r * (1.0 / 6)),
		middle = 1.0 / 24 + r * (1.0 / 120) + r2 * (1.0 / 720 + r * (1.0 / 5040)),
		high = 1.0 / 40320 + r * (1.0 / 362880);
	return (low + r4 * (middle + r4 * high)) * power_of_2(-turns);
}

double lod_log(double x)
{
	uint64_t bits;
	int exponent = 0;
	if (x < 1e-300) {
		x *= 18014398509481984;      /* 2^54: it may lack bits */
		exponent = -54;
	}
	memcpy(&bits, &x, sizeof bits);
	exponent += (int)(bits >> 52) - 1022;
	double m = x * power_of_2(1022 - (int)(bits >> 52));
	if (m < 0.70710678118654752440) {
		m *= 2;
		exponent--;
	}
	double t = (m - 1) / (m + 1), s = t * t, s2 = s * s;
	double sum = 1 + s * (1.0 / 3) + s2 * (1.0 / 5 + s * (1.0 / 7))
		+ s2 * s2 * (1.0 / 9 + s * (1.0 / 11) + s2 * (1.0 / 13));
	return 2 * t * sum + exponent * 0.69314718055994531;
}

double lod_octaves(double x) { return x > 0 ? 0.5 * lod_log(x) / 0.69314718055994530942 : 0; }

/* ---- Visibilities ---- */

void lod_screen_init(struct lod_screen *screen, const struct lod_eye *eye, const struct eco_view *view,
	bool ground)
{
	uint32_t side = view->width > view->height ? view->width : view->height;
	double cell = (double)side / LOD_SCREEN_COLUMNS;
	cell = cell > 4 ? cell : 4;  /* small pictures have few cells */
	*screen = (struct lod_screen){ .eye = eye, .ground = ground,
		.columns = (uint32_t)ceil(view->width / cell),
		.rows = (uint32_t)ceil(view->height / cell) };
	screen->cell_x = (double)view->width / screen->columns;
	screen->cell_y = (double)view->height / screen->rows;
}

void lod_screen_free(struct lod_screen *screen)
{
	free(screen->visibilities);
	free(screen->covers);
	*screen = (struct lod_screen){ 0 };
}

/* Layers of leaves across a crown, in the mean, of those that face the eye. */
static double layers_of(const struct lod_proxy_shape *proxy_shape)
{
	double ellipse = PI * proxy_shape->crown_across * proxy_shape->crown_up;
	return ellipse > 0 ? 0.5 * proxy_shape->area / ellipse : 0;
}

double lod_proxy_shape_opacity(const struct lod_proxy_shape *proxy_shape)
{
	return 1 - lod_exp_minus(layers_of(proxy_shape));
}

/* Leaves are clumped: what is behind is seen as if crowns were so much thinner (Nilson 1971: 0.6 to 0.9 in
 * forests). And leaves of a crown stand along its twigs: a picture shows less of them than of random leaves
 * (forests: 0.5 to 0.7). Both are fifths, as is all: one exponential tells each. */
#define CLUMPING_FIFTHS 4
#define TWIGS_FIFTHS 3

static void set_opacity(struct lod_visibility *visibility, const struct lod_proxy_shape *seen)
{
	double fifth = lod_exp_minus(layers_of(seen) / 5), square = fifth * fifth;
	_Static_assert(CLUMPING_FIFTHS == 4 && TWIGS_FIFTHS == 3, "powers below");
	visibility->opacity = (float)(1 - square * square * fifth);
	visibility->hides = (float)(1 - square * square);
	visibility->shown = (float)(1 - square * fifth);
}

struct lod_tilt lod_tilt_at(const struct lod_eye *eye, const double from_eye[3], double closest)
{
	double ahead = lod_dot(eye->forward, from_eye), slope = ahead > closest
		? lod_dot(eye->up, from_eye) / ahead : 0;
	double x = eye->up[0] - slope * eye->forward[0], y = eye->up[1] - slope * eye->forward[1];
	return (struct lod_tilt){ eye->up[2] - slope * eye->forward[2], sqrt(x * x + y * y) };
}

double lod_tilt_height(const struct lod_tilt *tilt, double across, double up)
{
	double upright = up * tilt->upright, level = across * tilt->level;
	return sqrt(upright * upright + level * level);
}

/* Squared distance of a proxy shape in its own radii: below 1 the eye is inside its ellipsoid. */
static double apart(const double d[3], const struct lod_proxy_shape *proxy_shape)
{
	double across = proxy_shape->across > 0 ? proxy_shape->across : proxy_shape->up,
		up = proxy_shape->up > 0 ? proxy_shape->up : proxy_shape->across;
	return (d[0] * d[0] + d[1] * d[1]) / (across * across) + d[2] * d[2] / (up * up);
}

/* An upright line of wood, at `level` metres along the ground, takes the integral of level / distance^3 over
 * its height in the picture; its height / distance^2 from afar. Branches lie otherwise, so from above it is no
 * less than that. */
static double wood_nearer(const double d[3], const struct lod_proxy_shape *shape)
{
	double thick = TRUNK * shape->crown_across, level2 = d[0] * d[0] + d[1] * d[1] + thick * thick,
		top = d[2] + shape->up, foot = d[2] - shape->up;
	if (!(level2 > 0 && shape->up > 0))
		return 1;
	return fmax(1, (level2 + d[2] * d[2]) / (2 * shape->up * sqrt(level2))
		* (top / sqrt(level2 + top * top) - foot / sqrt(level2 + foot * foot)));
}

/* From below the crown's middle, leaves lie before the trunk at the eye's height; from above, between the eye
 * and that middle. */
static double wood_behind(const double d[3], const struct lod_proxy_shape *shape)
{
	double down = d[2] + shape->rise < 0 && shape->crown_up > 0 ? (d[2] + shape->rise) / shape->crown_up : 0,
		across = shape->crown_across;
	return across > 0 ? fmin(1, sqrt((d[0] * d[0] + d[1] * d[1]) / (across * across) + down * down)) : 1;
}

struct lod_visibility *lod_screen_add(struct lod_screen *screen, const double center[3],
	const struct lod_proxy_shape *proxy_shape)
{
	if (!eco_array_grow(&screen->visibilities, &screen->capacity, screen->count, sizeof *screen->visibilities))
		return NULL;
	const struct lod_eye *eye = screen->eye;
	double d[3] = { center[0] - eye->at[0], center[1] - eye->at[1], center[2] - eye->at[2] };
	double ahead = lod_dot(eye->forward, d), size = fmax(proxy_shape->across, proxy_shape->up),
		closest = 0.25 * size;
	bool beside = ahead <= closest;
	double before = size > 0 ? fmax(0, fmin(1, ahead / closest - 1)) : 1,
		within = size > 0 && before < 1 ? lod_exp_minus(apart(d, proxy_shape)) : 0;
	within = !beside ? within + (1 - within) * before : size > 0
		? within * fmax(0, (ahead + size) / (closest + size)) : 0;
	struct lod_tilt tilt = lod_tilt_at(eye, d, closest);
	ahead = ahead > closest ? ahead : closest > 0 ? closest : 1e-9;
	double tall = lod_tilt_height(&tilt, proxy_shape->across, proxy_shape->up),
		high = lod_tilt_height(&tilt, proxy_shape->crown_across, proxy_shape->crown_up);
	double px = 1 / (ahead * eye->pixel_rad), columns = px / screen->cell_x, rows = px / screen->cell_y;
	struct lod_proxy_shape seen = { .area = proxy_shape->area, .crown_across = proxy_shape->crown_across,
		.crown_up = high };
	struct lod_visibility *visibility = &screen->visibilities[screen->count++];
	double y = 0.5 * screen->rows - lod_dot(eye->up, d) * rows,
		range = eye->right[0] * d[1] - eye->right[1] * d[0];
	*visibility =
		(struct lod_visibility){
		.x = (float)(0.5 * screen->columns + lod_dot(eye->right, d) * columns), .y = (float)y,
		.reach_x = (float)(BOX * proxy_shape->across * columns),
		.reach_y = (float)(BOX * tall * rows),
		.crown_y = (float)(y - proxy_shape->rise * tilt.upright * rows),
		.crown_reach_x = (float)(BOX * proxy_shape->crown_across * columns),
		.crown_reach_y = (float)(BOX * high * rows), .depth = (float)ahead, .distance = (float)sqrt(lod_dot(d, d)),
		.range = (float)(range > 0 ? range : 0),
		.foot = (float)(y + proxy_shape->up * tilt.upright * rows),
		.bottom = (float)screen->rows, .share = 1,
		.beside = beside,
		.within = (float)within, .before = (float)before,
		.wood_nearer = (float)wood_nearer(d, proxy_shape),
		.wood_behind = (float)wood_behind(d, proxy_shape) };
	set_opacity(visibility, &seen);
	visibility->ellipse = (float)(PI * proxy_shape->crown_across * high * px * px);
	visibility->pixels = visibility->opacity * visibility->ellipse;
	visibility->leaves = (float)(0.5 * proxy_shape->area * px * px);
	return visibility;
}

/* ---- Boxes of cells ---- */

struct span { int first, end; float low, high; };

/* Cells [first, end) that [low, high) touches, inside [0, count), whatever numbers these are. */
static struct span span_of(float middle, float reach, uint32_t count)
{
	float low = middle - reach, high = middle + reach, all = (float)count;
	low = low > 0 ? low < all ? low : all : 0;
	high = high > 0 ? high < all ? high : all : 0;
	int last = (int)high;
	return (struct span){ (int)low, last + ((float)last < high), low, high };
}

/* Length of cell i inside the span. */
static float inside(const struct span *s, int i)
{
	float low = s->low > (float)i ? s->low : (float)i, high = s->high < (float)(i + 1) ? s->high
		: (float)(i + 1);
	return high - low;
}

/* ---- Front to back ---- */

struct place { uint32_t key, index; };

/* A positive float's bits sort like its value. */
static void set_keys(const struct lod_screen *screen, bool by_range, struct place *places)
{
	for (uint32_t i = 0; i < screen->count; i++) {
		const struct lod_visibility *visibility = &screen->visibilities[i];
		memcpy(&places[i].key, by_range ? &visibility->range : &visibility->depth,
			sizeof places[i].key);
		places[i].index = i;
	}
}

/* Nearest first, stable: radix sort of floats' bits in an odd number of passes, so that the result is in
 * `to`. */
static void sort_visibilities(const struct lod_screen *screen, bool by_range, struct place *places,
	struct place *to)
{
	set_keys(screen, by_range, places);
	for (int shift = 0; shift < 33; shift += 11) {
		uint32_t start[2049] = { 0 };
		for (uint32_t i = 0; i < screen->count; i++)
			start[(places[i].key >> shift & 2047) + 1]++;
		for (int k = 0; k < 2047; k++)
			start[k + 1] += start[k];
		for (uint32_t i = 0; i < screen->count; i++)
			to[start[places[i].key >> shift & 2047]++] = places[i];
		struct place *swap = places;
		places = to;
		to = swap;
	}
}

/* Per cell: share of light let through so far, by clumped leaves and by random ones. Per column: first row
 * hidden by ground. */
struct light { float *through, *clear, *horizon; };

static struct span crown_across(const struct lod_screen *screen, const struct lod_visibility *s)
{
	return span_of(s->x, s->crown_reach_x, screen->columns);
}

/* Without the rows that ground hides. */
static struct span crown_down(const struct lod_screen *screen, const struct lod_visibility *s)
{
	struct span down = span_of(s->crown_y, s->crown_reach_y, screen->rows);
	down.high = fminf(down.high, s->bottom);
	return down;
}

/* Share of a visibility's box that is in the picture and lit. */
static double visible_share(const struct lod_screen *screen, const struct lod_visibility *visibility,
	const float *clear)
{
	struct span across = span_of(visibility->x, visibility->reach_x, screen->columns),
		down = span_of(visibility->y, visibility->reach_y, screen->rows);
	double seen = 0;
	down.high = fminf(down.high, visibility->bottom);
	for (int r = down.first; r < down.end; r++) {
		const float *row = clear + r * (int)screen->columns;
		float height = fmaxf(0, inside(&down, r)), sum = 0;
		for (int c = across.first; c < across.end; c++)
			sum += inside(&across, c) * row[c];
		seen += (double)(height * sum);
	}
	double all = 4 * (double)visibility->reach_x * (double)visibility->reach_y;
	return (all > seen ? seen / all : 1) * (double)visibility->within;
}

static void attenuate(const struct lod_screen *screen, const struct lod_visibility *visibility,
	const struct light *light)
{
	float opaque = visibility->hides * visibility->within,
		clear_of = visibility->opacity * visibility->within;
	struct span across = crown_across(screen, visibility), down = crown_down(screen, visibility);
	for (int r = down.first; r < down.end; r++) {
		float *clear = light->clear + r * (int)screen->columns,
			*through = light->through + r * (int)screen->columns;
		float height = fmaxf(0, inside(&down, r));
		for (int c = across.first; c < across.end; c++) {
			float part = height * inside(&across, c);
			clear[c] *= 1 - part * clear_of;
			through[c] *= 1 - part * opaque;
		}
	}
}

/* Share of a visibility's surroundings, a box AROUND times as wide and high, that is in the picture and that
 * no other plant covers: light that comes through all crowns but its own. */
static double unoccluded_share(const struct lod_screen *screen, const struct lod_visibility *visibility,
	const float *clear)
{
	struct span across = span_of(visibility->x, (float)AROUND * visibility->reach_x, screen->columns);
	struct span down = span_of(visibility->y, (float)AROUND * visibility->reach_y, screen->rows);
	struct span crown = crown_across(screen, visibility), high = crown_down(screen, visibility);
	double seen = 0;
	down.high = fminf(down.high, visibility->bottom);
	for (int r = down.first; r < down.end; r++) {
		const float *row = clear + r * (int)screen->columns;
		float height = fmaxf(0, inside(&down, r)), sum = 0;
		float own = r >= high.first && r < high.end
			? fmaxf(0, inside(&high, r)) * visibility->opacity * visibility->within : 0;
		for (int c = across.first; c < across.end; c++) {
			float rest = 1 - (c >= crown.first && c < crown.end ? own * inside(&crown, c) : 0);
			sum += inside(&across, c) * (rest > CLEAR_LEAST ? row[c] / rest : 0);
		}
		seen += (double)(height * sum);
	}
	double all = 4 * AROUND * AROUND * (double)visibility->reach_x * (double)visibility->reach_y;
	return (all > seen ? seen / all : 1) * (double)visibility->within;
}

/* Sets the row from which on ground hides the visibility, then lowers the horizon to its foot: one cell below
 * it, so that neighbours are not hidden, and less beside it and for a plant near the eye, so that nothing
 * changes at once. */
static void lower_horizon(const struct lod_screen *screen, struct lod_visibility *visibility, float *horizon)
{
	float rows = (float)screen->rows, foot = fminf(visibility->foot + 1, rows), at = visibility->x - 0.5f;
	if (!(at >= -1 && at < (float)screen->columns))
		return;                  /* may be farther off than an int says */
	int last = (int)screen->columns - 1, column = (int)floorf(at);
	float part = at - (float)column;
	int left = column < 0 ? 0 : column, right = column < last ? column + 1 : last;
	float bottom = horizon[left] + part * (horizon[right] - horizon[left]);
	visibility->bottom = rows + visibility->before * (bottom - rows);
	for (int c = column - (int)HILL + 1; c <= column + (int)HILL; c++) {
		float beside = fabsf(at - (float)c) / HILL;
		if (c >= 0 && c <= last && beside < 1)
			horizon[c] =
				fminf(horizon[c], rows + visibility->before * (1 - beside) * (foot - rows));
	}
}

/* Sets the row from which on ground hides each visibility. */
static void hide_by_ground(const struct lod_screen *screen, float *horizon, struct place *order,
	struct place *spare)
{
	for (uint32_t c = 0; c < screen->columns; c++)
		horizon[c] = (float)screen->rows;
	sort_visibilities(screen, true, order, spare);
	for (uint32_t i = 0; i < screen->count; i++) {
		struct lod_visibility *visibility = &screen->visibilities[spare[i].index];
		if (visibility->range > 0 && visibility->before > 0)
			lower_horizon(screen, visibility, horizon);
	}
}

/* From the nearest to the farthest: takes the light that is left, then hides what is behind. */
static void occlude(const struct lod_screen *screen, struct lod_visibility *visibility,
	const struct light *light)
{
	visibility->share = (float)visible_share(screen, visibility, light->through);
	attenuate(screen, visibility, light);
}

static uint64_t cells_of(const struct lod_screen *screen, const struct lod_visibility *visibility)
{
	struct span across = span_of(visibility->x, (float)AROUND * visibility->reach_x, screen->columns);
	struct span down = span_of(visibility->y, (float)AROUND * visibility->reach_y, screen->rows);
	return (uint64_t)(across.end - across.first) * (uint64_t)(down.end - down.first);
}

uint64_t lod_screen_cells(const struct lod_screen *screen)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < screen->count; i++)
		sum += cells_of(screen, &screen->visibilities[i]);
	return sum;
}

static float scaled(float at, double by) { return (float)((double)at * by); }

void lod_screen_coarsen(struct lod_screen *screen)
{
	uint32_t columns = (screen->columns + 1) / 2, rows = (screen->rows + 1) / 2;
	double across = (double)columns / screen->columns, down = (double)rows / screen->rows;
	for (uint32_t i = 0; i < screen->count; i++) {
		struct lod_visibility *v = &screen->visibilities[i];
		v->x = scaled(v->x, across);
		v->reach_x = scaled(v->reach_x, across);
		v->crown_reach_x = scaled(v->crown_reach_x, across);
		v->y = scaled(v->y, down);
		v->reach_y = scaled(v->reach_y, down);
		v->crown_y = scaled(v->crown_y, down);
		v->crown_reach_y = scaled(v->crown_reach_y, down);
		v->foot = scaled(v->foot, down);
		v->bottom = (float)rows;
	}
	screen->cell_x /= across;
	screen->cell_y /= down;
	screen->columns = columns;
	screen->rows = rows;
	screen->shared = 0;
}

static void finish(const struct lod_screen *screen, struct lod_visibility *visibility,
	const struct light *light, bool hide)
{
	double seen = hide ? (double)visibility->share : visible_share(screen, visibility, light->clear);
	double unoccluded = hide ? unoccluded_share(screen, visibility, light->clear) : seen;
	/* not more of a plant than the picture holds: where the eye is inside it, SEEN_LEAST may be more than
	 * all pixels */
	double least =
		SEEN_LEAST * fmin(1,
		screen->columns * screen->rows
		/ (1 + 4 * (double)visibility->reach_x * (double)visibility->reach_y));
	visibility->share = (float)(seen > least ? seen : least);
	unoccluded = LOD_OWNER_WEIGHT * (double)visibility->share + (1 - LOD_OWNER_WEIGHT) * unoccluded;
	visibility->unoccluded = unoccluded < (double)visibility->share ? (float)unoccluded
		: visibility->share;
}

static bool make_covers(struct lod_screen *screen);

enum eco_code lod_screen_shares(struct lod_screen *screen, bool hide, struct eco_error *error)
{
	uint32_t cells = screen->columns * screen->rows;
	if (screen->count && screen->shared == screen->count)
		return ECO_OK;
	struct place *order = malloc(((size_t)screen->count + 1) * sizeof *order),
		*spare = malloc(((size_t)screen->count + 1) * sizeof *spare);
	struct light light = { malloc(cells * sizeof *light.through), malloc(cells * sizeof *light.clear),
		malloc(screen->columns * sizeof *light.horizon) };
	bool good = order && spare && light.through && light.clear && light.horizon;
	if (good) {
		for (uint32_t i = 0; i < cells; i++)
			light.through[i] = light.clear[i] = 1;
		if (screen->ground && hide)
			hide_by_ground(screen, light.horizon, order, spare);
		sort_visibilities(screen, false, order, spare);
		for (uint32_t i = 0; hide && i < screen->count; i++)
			occlude(screen, &screen->visibilities[spare[i].index], &light);
		for (uint32_t i = 0; i < screen->count; i++)
			finish(screen, &screen->visibilities[i], &light, hide);
		good = make_covers(screen);
		screen->shared = good ? screen->count : 0;
	}
	free(order);
	free(spare);
	free(light.through);
	free(light.clear);
	free(light.horizon);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u plants in view",
		screen->count);
}

/* ---- Prediction ---- */

/* Probabilities that a point is uncovered: in the reference, as drawn, and in both. The fourth lane is for
 * whole vectors only. */
enum { REFERENCE, DRAWN, EITHER };

static lod_f4 uncovered_of(double shown, struct lod_wrong wrong)
{
	double reference = 1 - shown, drawn = 1 - shown * (1 - wrong.fn + wrong.fp),
		either = 1 - shown * (1 + wrong.fp);
	/* a point uncovered in both is uncovered in each */
	drawn = drawn > 0 ? drawn : 0;
	either = either > 0 ? either : 0;
	return (lod_f4){ (float)reference, (float)drawn, (float)(either < drawn ? either : drawn), 1 };
}

/* Screen cover of a crown, as far as it does not depend on what is drawn. */
struct lod_cover { struct span across, down; float shown, before; uint32_t of; };

/* Those of all visibilities that are somewhere in the picture; false: no memory. */
static bool make_covers(struct lod_screen *screen)
{
	free(screen->covers);
	screen->cover_count = 0;
	screen->covers = malloc(((size_t)screen->count + 1) * sizeof *screen->covers);
	for (uint32_t i = 0; screen->covers && i < screen->count; i++) {
		struct lod_visibility wide = screen->visibilities[i];
		if (wide.shown > (float)DENSEST) {
			float wider = sqrtf(wide.shown / (float)DENSEST);
			wide.crown_reach_x *= wider;
			wide.crown_reach_y *= wider;
			wide.shown = (float)DENSEST;
		}
		struct lod_cover cover = { crown_across(screen, &wide), crown_down(screen, &wide), wide.shown,
			wide.before, i };
		if (!wide.beside && cover.across.first < cover.across.end && cover.down.first < cover.down.end)
			screen->covers[screen->cover_count++] = cover;
	}
	return screen->covers;
}

static void cover_cells(const struct lod_screen *screen, const struct lod_cover *cover, lod_f4 uncovered,
	lod_f4 *cells)
{
	lod_f4 one = lod_f4_all(1), covered = (one - uncovered) * lod_f4_all(cover->before);
	for (int r = cover->down.first; r < cover->down.end; r++) {
		lod_f4 *row = cells + r * (int)screen->columns, part = covered
			* lod_f4_all(fmaxf(0, inside(&cover->down, r)));
		for (int c = cover->across.first; c < cover->across.end; c++)
			row[c] *= one - part * lod_f4_all(inside(&cover->across, c));
	}
}

/* Layers of splats, over the crown as it covers. False: no memory. */
static bool add_splats(const struct lod_screen *screen, const struct lod_cover *cover,
	const struct lod_splats *splats, struct lod_splat_field *field)
{
	const struct lod_visibility *visibility = &screen->visibilities[cover->of];
	double wider = (double)visibility->shown / (double)cover->shown, box = wider * 4 * screen->cell_x
		* screen->cell_y * (double)visibility->crown_reach_x * (double)visibility->crown_reach_y;
	float *cells = lod_splat_field_of(field, splats->side), layers = box > 0 ? (float)((double)cover->before
		* splats->count * splats->side * splats->side / box) : 0;
	for (int r = cover->down.first; cells && r < cover->down.end; r++) {
		float *row = cells + r * (int)screen->columns,
			part = layers * fmaxf(0, inside(&cover->down, r));
		for (int c = cover->across.first; c < cover->across.end; c++)
			row[c] += part * inside(&cover->across, c);
	}
	return cells;
}

static bool cover_all(const struct lod_screen *screen, lod_drawn_fn drawn_of, void *ctx, lod_f4 *cells,
	struct lod_splat_field *field)
{
	bool good = true;
	for (uint32_t i = 0; i < screen->cover_count && good; i++) {
		const struct lod_cover *cover = &screen->covers[i];
		struct lod_drawn drawn = drawn_of(ctx, &screen->visibilities[cover->of]);
		float clear = 1 - cover->shown;
		bool splats = drawn.splats.count > 0;
		cover_cells(screen, cover, splats ? (lod_f4){ clear, 1, clear, 1 }
			: uncovered_of((double)cover->shown, drawn.wrong), cells);
		good = !splats || add_splats(screen, cover, &drawn.splats, field);
	}
	return good;
}

static struct eco_prediction sum_up(const struct lod_screen *screen, const lod_f4 *cells, const float *layers)
{
	double tp = 0, fp = 0, fn = 0, pixels = screen->cell_x * screen->cell_y;
	for (uint32_t i = 0; i < screen->columns * screen->rows; i++) {
		double through = layers && layers[i] > 0 ? lod_exp_minus((double)layers[i]) : 1,
			reference = (double)cells[i][REFERENCE], drawn = through * (double)cells[i][DRAWN];
		double either = fmin(through * (double)cells[i][EITHER], fmin(reference, drawn));
		fp += reference - either;
		fn += drawn - either;
		tp += fmax(0, 1 - reference - drawn + either);
	}
	return (struct eco_prediction){ tp * pixels, fp * pixels, fn * pixels };
}

enum eco_code lod_screen_expect(const struct lod_screen *screen, lod_drawn_fn drawn, void *ctx,
	struct eco_prediction *prediction, struct eco_error *error)
{
	uint32_t count = screen->columns * screen->rows;
	lod_f4 *cells = malloc(count * sizeof *cells);
	struct lod_splat_field field = { screen->columns, screen->rows, screen->cell_x, screen->cell_y,
		NULL, NULL, 0 };
	for (uint32_t i = 0; cells && i < count; i++)
		cells[i] = lod_f4_all(1);
	bool good = cells && cover_all(screen, drawn, ctx, cells, &field);
	if (good)
		*prediction = sum_up(screen, cells, lod_splat_field_blur(&field));
	lod_splat_field_free(&field);
	free(cells);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a screen of %u cells",
		count);
}
