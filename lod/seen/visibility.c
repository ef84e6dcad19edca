/* Visibilities on the coarse screen: see lod/seen/visibility.h. Longer than 600 lines: cells of outlines serve light and
 * prediction, and no other file sees them. */
#include "lod/seen/visibility.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/lanes.h"

#define PI 3.14159265358979323846
#define CLEAR_LEAST 1e-6f        /* light through the own crown below which that of others is not told */
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

/* ---- Cells of an outline ---- */

struct span { int first, end; float low, high; };
struct lod_run { struct span across; float height; };        /* of an outline in a row, in cells */

/* Cells [first, end) that [low, high) touches, inside [0, count), whatever numbers these are. */
static struct span span_of(double from, double to, uint32_t count)
{
	float low = (float)from, high = (float)to, all = (float)count;
	low = low > 0 ? low < all ? low : all : 0;
	high = high > low ? high < all ? high : all : low;
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

static double columns_of(const struct lod_screen *screen, double x) { return x * screen->per_x; }
static double rows_of(const struct lod_screen *screen, double y) { return y * screen->per_y; }

/* Rows that it reaches above the row `bottom`. */
static struct span rows_reached(const struct lod_screen *screen, const struct lod_outline *outline, float bottom)
{
	double y = 0.5 * screen->rows - rows_of(screen, outline->y), high = rows_of(screen, outline->high);
	if (outline->around)
		return span_of(0, (double)bottom, screen->rows);
	high *= high < LOD_SCREEN_SMALL ? BOX : 1;
	return span_of(y - high, fmin(y + high, (double)bottom), screen->rows);
}

/* Weights of three intervals in a row, of its middle and of its two ends: exact for an ellipse within one row, and
 * nearly so for more rows. So cells add up to the outline's area. */
#define MIDDLE_WEIGHT (PI / 4)
#define END_WEIGHT (0.5 - PI / 8)

static double chord(double v) { return v * v < 1 ? sqrt(1 - v * v) : 0; }

static struct span cells_of_ellipse(const struct lod_screen *screen, const struct lod_outline *o, double top,
	double bottom)
{
	double high = rows_of(screen, o->high), part = high > 0 ? 1 / high : 0,
		y = 0.5 * screen->rows - rows_of(screen, o->y), v = (0.5 * (top + bottom) - y) * part,
		middle = 0.5 * screen->columns + columns_of(screen, o->x - o->lean * v * o->high),
		reach = columns_of(screen, o->half);
	reach *= high < LOD_SCREEN_SMALL ? BOX : MIDDLE_WEIGHT * chord(v)
		+ END_WEIGHT * (chord((top - y) * part) + chord((bottom - y) * part));
	return span_of(middle - reach, middle + reach, screen->columns);
}

/* Ends of intervals are at most one picture beyond the picture's sides. */
static struct span cells_around(const struct lod_screen *screen, const struct lod_outline *o, double top,
	double bottom)
{
	const double at[3] = { 0.5 * (top + bottom), top, bottom }, all = screen->columns;
	double mean[2] = { 0, 0 }, middle = 0;
	for (int i = 0; i < 3; i++) {
		double ends[2];
		bool found = lod_outline_row(o, screen->eye, (0.5 * screen->rows - at[i]) / screen->per_y, &ends[0],
			&ends[1]);
		if (!found && i == 0)
			return (struct span){ 0, 0, 0, 0 };
		for (int k = 0; k < 2; k++) {
			ends[k] = found ? fmin(fmax(0.5 * all + columns_of(screen, ends[k]), -all), 2 * all) : middle;
			mean[k] += ends[k] * (i ? END_WEIGHT : MIDDLE_WEIGHT);
		}
		middle = i ? middle : 0.5 * (ends[0] + ends[1]);
	}
	return span_of(mean[0], mean[1], screen->columns);
}

/* The mean of its intervals over the part of a row that it reaches. */
static struct span cells_of_row(const struct lod_screen *screen, const struct lod_outline *outline,
	const struct span *down, int row)
{
	double top = down->low > (float)row ? (double)down->low : row,
		bottom = down->high < (float)(row + 1) ? (double)down->high : row + 1;
	return (outline->around ? cells_around : cells_of_ellipse)(screen, outline, top, bottom);
}

/* Light that a near crown takes of a cell in it, by the way of a ray through the cell's middle. */
static float taken_at(const struct lod_screen *screen, uint32_t index, int row, int column)
{
	double x = (column + 0.5 - 0.5 * screen->columns) / screen->per_x,
		y = (0.5 * screen->rows - row - 0.5) / screen->per_y;
	return (float)(1 - lod_exp_minus((double)screen->visibilities[index].density
		* lod_outline_way(&screen->crowns[index], screen->eye, x, y)));
}

/* Cells of runs; those that leaves or wood cover; the same, times the light there. */
struct lit { double cells, all, lit; };

/* Takes light along runs, from a row on: `part` of it, or of a near crown by ray where it is negative. */
static struct lit take_light(const struct lod_screen *screen, uint32_t index, const struct lod_runs *runs, float part,
	float *light)
{
	struct lit sum = { 0, 0, 0 };
	for (int r = runs->row; r < runs->end; r++) {
		const struct lod_run *run = &screen->runs[runs->first + (uint32_t)(r - runs->row)];
		float *row = light + r * (int)screen->columns, all = 0, lit = 0;
		for (int c = run->across.first; c < run->across.end; c++) {
			float taken = run->height * inside(&run->across, c)
				* (part < 0 ? taken_at(screen, index, r, c) : part);
			all += taken;
			lit += taken * row[c];
			row[c] *= 1 - taken;
		}
		sum.cells += (double)(run->height * (run->across.high - run->across.low));
		sum.all += (double)all;
		sum.lit += (double)lit;
	}
	return sum;
}

/* Cells of runs that are still lit. */
static double lit_of(const struct lod_screen *screen, const struct lod_runs *runs, const float *light)
{
	double sum = 0;
	for (int r = runs->row; r < runs->end; r++) {
		const struct lod_run *run = &screen->runs[runs->first + (uint32_t)(r - runs->row)];
		const float *row = light + r * (int)screen->columns;
		float lit = 0;
		for (int c = run->across.first; c < run->across.end; c++)
			lit += inside(&run->across, c) * row[c];
		sum += (double)(run->height * lit);
	}
	return sum;
}

/* False: no memory. */
static bool make_runs(struct lod_screen *screen, const struct lod_outline *outline, float bottom,
	struct lod_runs *runs)
{
	struct span down = rows_reached(screen, outline, bottom);
	*runs = (struct lod_runs){ screen->run_count, (uint16_t)down.first, (uint16_t)down.end };
	for (int r = down.first; r < down.end; r++) {
		if (!eco_array_grow(&screen->runs, &screen->run_capacity, screen->run_count, sizeof *screen->runs))
			return false;
		screen->runs[screen->run_count++] = (struct lod_run){ cells_of_row(screen, outline, &down, r),
			inside(&down, r) };
	}
	return true;
}

static const struct lod_run *crown_run(const struct lod_screen *screen, const struct lod_visibility *v, int row)
{
	return &screen->runs[v->crown.first + (uint32_t)(row - v->crown.row)];
}

static double area_of(const struct lod_screen *screen, const struct lod_outline *outline)
{
	return columns_of(screen, rows_of(screen, lod_outline_area(outline)));
}

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
	screen->per_x = 1 / (eye->pixel_rad * screen->cell_x);
	screen->per_y = 1 / (eye->pixel_rad * screen->cell_y);
}

void lod_screen_free(struct lod_screen *screen)
{
	free(screen->visibilities);
	free(screen->crowns);
	free(screen->stems);
	free(screen->runs);
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

/* Share of an ellipsoid's outline that is covered where leaves lie in it evenly, so many layers in its middle: the
 * mean of 1 - exp(-layers chord) over parallel rays. */
static double covered_by(double layers)
{
	double square = layers * layers;
	if (layers < 1e-3)
		return 2.0 / 3 * layers - square / 4;
	return 1 - 2 * (1 - (1 + layers) * lod_exp_minus(layers)) / square;
}

double lod_height_seen(double across, double up, const double from_eye[3])
{
	double square = lod_dot(from_eye, from_eye), steep = square > 0 ? from_eye[2] * from_eye[2] / square : 0;
	return sqrt(across * across * steep + up * up * (1 - steep));
}

/* An upright line of wood, at `level` metres along the ground, takes the integral of level / distance^3 over
 * its height in the picture; its height / distance^2 from afar. Branches lie otherwise, so from above it is no
 * less than that. */
static double wood_nearer(const double d[3], const struct lod_proxy_shape *shape)
{
	double thick = LOD_SCREEN_TRUNK * shape->crown_across, level2 = d[0] * d[0] + d[1] * d[1] + thick * thick,
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

/* Layers of leaves that face the eye, a metre of its way through the crown. */
static double density_of(const struct lod_proxy_shape *shape)
{
	double volume = 4.0 / 3 * PI * shape->crown_across * shape->crown_across * shape->crown_up;
	return volume > 0 ? 0.5 * shape->leaf_area / volume : 0;
}

/* The mean way across a crown: its volume over its area across the line of sight. */
static double way_across(const struct lod_proxy_shape *shape, const double from_eye[3])
{
	double high = lod_height_seen(shape->crown_across, shape->crown_up, from_eye);
	return high > 0 ? 4.0 / 3 * shape->crown_across * shape->crown_up / high : 0;
}

struct lod_visibility *lod_screen_add(struct lod_screen *screen, const double center[3],
	const struct lod_proxy_shape *proxy_shape)
{
	if (!eco_array_grow(&screen->visibilities, &screen->capacity, screen->count, sizeof *screen->visibilities)
			|| !eco_array_grow(&screen->crowns, &screen->crown_capacity, screen->count,
			sizeof *screen->crowns)
			|| !eco_array_grow(&screen->stems, &screen->stem_capacity, screen->stem_count,
			sizeof *screen->stems))
		return NULL;
	const struct lod_eye *eye = screen->eye;
	double d[3] = { center[0] - eye->at[0], center[1] - eye->at[1], center[2] - eye->at[2] },
		crown[3] = { d[0], d[1], d[2] + proxy_shape->rise }, foot[3] = { d[0], d[1], d[2] - proxy_shape->up };
	double ahead = lod_dot(eye->forward, d), closest = LOD_SCREEN_CLOSEST * fmax(proxy_shape->across, proxy_shape->up),
		under = fmax(lod_dot(eye->forward, foot), 1e-9), range = eye->right[0] * d[1] - eye->right[1] * d[0];
	struct lod_outline *outline = &screen->crowns[screen->count];
	struct lod_visibility *visibility = &screen->visibilities[screen->count++];
	*visibility = (struct lod_visibility){
		.foot_x = (float)(0.5 * screen->columns + lod_dot(eye->right, foot) / under * screen->per_x),
		.foot = (float)(0.5 * screen->rows - lod_dot(eye->up, foot) / under * screen->per_y),
		.depth = (float)(ahead > closest ? ahead : closest > 0 ? closest : 1e-9),
		.distance = (float)sqrt(lod_dot(d, d)), .range = (float)(range > 0 ? range : 0),
		.bottom = (float)screen->rows, .share = 1,
		.before = closest > 0 ? (float)fmax(0, fmin(1, ahead / closest - 1)) : 1,
		.wood_nearer = (float)wood_nearer(d, proxy_shape),
		.wood_behind = (float)wood_behind(d, proxy_shape) };
	lod_outline_make(outline, eye, crown, proxy_shape->crown_across, proxy_shape->crown_up);
	double stem = 0;             /* cells of its outline */
	if (proxy_shape->stem > 0
			&& proxy_shape->up * screen->per_y > LOD_SCREEN_STEM_ROWS * (double)visibility->distance) {
		struct lod_outline *made = &screen->stems[screen->stem_count].outline;
		lod_outline_make(made, eye, d, proxy_shape->stem, proxy_shape->up);
		stem = area_of(screen, made);
		visibility->stem = ++screen->stem_count;
	}
	double shadow = proxy_shape->crown_across;
	if (shadow * screen->per_y > LOD_SCREEN_STEM_ROWS * (double)visibility->distance) {
		if (!eco_array_grow(&screen->stems, &screen->stem_capacity, screen->stem_count, sizeof *screen->stems))
			return NULL;
		lod_outline_make(&screen->stems[screen->stem_count].outline, eye, foot, shadow, LOD_SCREEN_SHADE_FLAT * shadow);
		visibility->shadow = ++screen->stem_count;
	}
	double density = density_of(proxy_shape);
	double across = way_across(proxy_shape, crown);
	visibility->near = outline->around
		|| lod_dot(crown, crown) < LOD_SCREEN_NEAR * LOD_SCREEN_NEAR * proxy_shape->crown_across * proxy_shape->crown_up;
	visibility->density = (float)(LOD_SCREEN_CLUMPED * density);
	visibility->opacity = (float)(1 - lod_exp_minus(density * across));
	visibility->shown = (float)covered_by(1.5 * LOD_SCREEN_CLUMPED * density * across);
	double px = 1 / ((double)visibility->depth * eye->pixel_rad), cell = screen->cell_x * screen->cell_y;
	visibility->ellipse = (float)(cell * area_of(screen, outline));
	visibility->pixels = (float)((double)(visibility->shown * visibility->ellipse) + cell * stem);
	visibility->leaves = (float)(0.5 * proxy_shape->leaf_area * px * px);
	return visibility;
}

/* ---- Front to back ---- */

struct place { uint32_t key, index; };

/* A positive float's bits sort like its value. */
static void set_keys(const struct lod_screen *screen, bool by_range, struct place *places)
{
	for (uint32_t i = 0; i < screen->count; i++) {
		const struct lod_visibility *visibility = &screen->visibilities[i];
		memcpy(&places[i].key, by_range ? &visibility->range : &visibility->distance,
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

/* Per cell: share of light let through so far. Per column: first row hidden by ground. */
struct light { float *cells, *horizon; };

/* The box so many times as wide and high as the crown, blurred by a square of `side` pixels; around the eye the picture.
 * Returns its cells, in the picture or not. */
static double box_around(const struct lod_screen *screen, uint32_t index, double times, double side, struct span *across,
	struct span *down)
{
	const struct lod_outline *o = &screen->crowns[index];
	double x = 0.5 * screen->columns + columns_of(screen, o->x), y = 0.5 * screen->rows - rows_of(screen, o->y),
		w = times * BOX * columns_of(screen, o->wide), h = times * BOX * rows_of(screen, o->high),
		more_w = 0.5 * side / screen->cell_x, more_h = 0.5 * side / screen->cell_y,
		wide = sqrt(w * w + more_w * more_w), high = sqrt(h * h + more_h * more_h);
	if (o->around) {
		x = wide = 0.5 * screen->columns;
		y = high = 0.5 * screen->rows;
	}
	*across = span_of(x - wide, x + wide, screen->columns);
	*down = span_of(y - high, fmin(y + high, (double)screen->visibilities[index].bottom), screen->rows);
	return 4 * wide * high;
}

/* Share of a visibility's surroundings that is in the picture and that no other plant covers: light that comes
 * through all crowns but its own. */
static double unoccluded_share(const struct lod_screen *screen, uint32_t index, const float *light)
{
	const struct lod_visibility *v = &screen->visibilities[index];
	struct span across, down;
	double seen = 0, all = box_around(screen, index, LOD_SCREEN_AROUND, 0, &across, &down);
	for (int r = down.first; r < down.end; r++) {
		const float *row = light + r * (int)screen->columns;
		const struct lod_run *run = r >= v->crown.row && r < v->crown.end ? crown_run(screen, v, r) : NULL;
		float sum = 0;
		for (int c = across.first; c < across.end; c++) {
			bool own = run && c >= run->across.first && c < run->across.end;
			float rest = own ? 1 - v->shown * run->height * inside(&run->across, c) : 1;
			sum += inside(&across, c) * (rest > CLEAR_LEAST ? row[c] / rest : 0);
		}
		seen += (double)(inside(&down, r) * sum);
	}
	return all > seen ? seen / all : seen > 0;
}

/* Sets the row from which on ground hides the visibility, then lowers the horizon to its foot: one cell below
 * it, so that neighbours are not hidden, and less beside it and for a plant near the eye, so that nothing
 * changes at once. */
static void lower_horizon(const struct lod_screen *screen, struct lod_visibility *visibility, float *horizon)
{
	float rows = (float)screen->rows, foot = fminf(visibility->foot + 1, rows), at = visibility->foot_x - 0.5f;
	if (!(at >= -1 && at < (float)screen->columns))
		return;                  /* may be farther off than an int says */
	int last = (int)screen->columns - 1, column = (int)floorf(at);
	float part = at - (float)column;
	int left = column < 0 ? 0 : column, right = column < last ? column + 1 : last;
	float bottom = horizon[left] + part * (horizon[right] - horizon[left]);
	visibility->bottom = rows + visibility->before * (bottom - rows);
	for (int c = column - (int)LOD_SCREEN_HILL + 1; c <= column + (int)LOD_SCREEN_HILL; c++) {
		float beside = fabsf(at - (float)c) / LOD_SCREEN_HILL;
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

/* From the nearest to the farthest: takes the light that is left. */
static void take(const struct lod_screen *screen, uint32_t index, float *light)
{
	struct lod_visibility *v = &screen->visibilities[index];
	double cell = screen->cell_x * screen->cell_y;
	struct lit crown = take_light(screen, index, &v->crown, v->near ? -1 : v->shown, light),
		stem = { 0, 0, 0 };
	if (v->stem)
		stem = take_light(screen, index, &screen->stems[v->stem - 1].runs, 1, light);
	if (v->near) {
		v->ellipse = (float)(cell * crown.cells);
		v->shown = crown.cells > 0 ? (float)(crown.all / crown.cells) : 0;
		v->pixels = (float)(cell * (crown.all + stem.all));
	}
	double seen = cell * (crown.lit + stem.lit);
	if (v->near)
		seen = fmax(seen, LOD_SCREEN_SHADOW * fmin((double)v->leaves, cell * screen->columns * screen->rows));
	if (v->shadow)
		v->shade = (float)(LOD_SCREEN_SHADE * (double)v->opacity * cell
			* lit_of(screen, &screen->stems[v->shadow - 1].runs, light));
	v->pixels = fmaxf(v->pixels, (float)seen);
	v->share = v->pixels > 0 ? (float)seen / v->pixels : 0;
}

uint64_t lod_screen_cells(const struct lod_screen *screen)
{
	uint64_t sum = 0;
	struct span across, down;
	for (uint32_t i = 0; i < screen->count; i++) {
		box_around(screen, i, LOD_SCREEN_AROUND, 0, &across, &down);
		sum += (uint64_t)(across.end - across.first) * (uint64_t)(down.end - down.first);
	}
	return sum;
}

static float scaled(float at, double by) { return (float)((double)at * by); }

void lod_screen_coarsen(struct lod_screen *screen)
{
	uint32_t columns = (screen->columns + 1) / 2, rows = (screen->rows + 1) / 2;
	double across = (double)columns / screen->columns, down = (double)rows / screen->rows;
	for (uint32_t i = 0; i < screen->count; i++) {
		struct lod_visibility *v = &screen->visibilities[i];
		v->foot_x = scaled(v->foot_x, across);
		v->foot = scaled(v->foot, down);
		v->bottom = (float)rows;
	}
	screen->cell_x /= across;
	screen->cell_y /= down;
	screen->per_x *= across;
	screen->per_y *= down;
	screen->columns = columns;
	screen->rows = rows;
	screen->shared = 0;
}

static void finish(const struct lod_screen *screen, uint32_t index, const float *light, bool hide)
{
	struct lod_visibility *v = &screen->visibilities[index];
	double least = LOD_SCREEN_SEEN_LEAST * fmin(1, screen->columns * screen->rows * screen->cell_x * screen->cell_y
		/ (1 + (double)v->ellipse));
	v->share = fmaxf(v->share, (float)least);
	double unoccluded = hide ? unoccluded_share(screen, index, light) : (double)v->share;
	unoccluded = LOD_OWNER_WEIGHT * (double)v->share + (1 - LOD_OWNER_WEIGHT) * unoccluded;
	v->unoccluded = fminf((float)unoccluded, v->share);
}

enum eco_code lod_screen_shares(struct lod_screen *screen, bool hide, struct eco_error *error)
{
	uint32_t cells = screen->columns * screen->rows;
	if (screen->count && screen->shared == screen->count)
		return ECO_OK;
	struct place *order = malloc(((size_t)screen->count + 1) * sizeof *order),
		*spare = malloc(((size_t)screen->count + 1) * sizeof *spare);
	struct light light = { malloc(cells * sizeof *light.cells), malloc(screen->columns * sizeof *light.horizon) };
	bool good = order && spare && light.cells && light.horizon;
	if (good) {
		if (screen->ground && hide)
			hide_by_ground(screen, light.horizon, order, spare);
		sort_visibilities(screen, false, order, spare);
		screen->run_count = 0;
		for (uint32_t i = 0; i < screen->count && good; i++) {
			struct lod_visibility *v = &screen->visibilities[i];
			struct lod_stem *stem = v->stem ? &screen->stems[v->stem - 1] : NULL;
			good = make_runs(screen, &screen->crowns[i], v->bottom, &v->crown)
				&& (!stem || make_runs(screen, &stem->outline, v->bottom, &stem->runs));
			stem = v->shadow ? &screen->stems[v->shadow - 1] : NULL;
			good = good && (!stem || make_runs(screen, &stem->outline, (float)screen->rows, &stem->runs));
		}
		for (uint32_t i = 0; i < screen->count && good; i++) {
			for (uint32_t c = 0; c < cells && (i == 0 || !hide); c++)
				light.cells[c] = 1;
			take(screen, spare[i].index, light.cells);
		}
		for (uint32_t i = 0; i < screen->count && good; i++)
			finish(screen, i, light.cells, hide);
		screen->shared = good ? screen->count : 0;
	}
	free(order);
	free(spare);
	free(light.cells);
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

/* A crown as it covers cells: denser than LOD_SCREEN_DENSEST, it covers as much of wider runs, so that false positives lie around
 * it. */
struct cover { const struct lod_visibility *v; float shown, wider; };

static struct cover cover_of(const struct lod_visibility *v)
{
	return v->shown > LOD_SCREEN_DENSEST ? (struct cover){ v, LOD_SCREEN_DENSEST, v->shown / LOD_SCREEN_DENSEST } : (struct cover){ v, v->shown, 1 };
}

static struct span cover_run(const struct lod_screen *screen, const struct cover *cover, int row, float *height)
{
	const struct lod_run *run = crown_run(screen, cover->v, row);
	const struct span *s = &run->across;
	*height = run->height;
	if (!(cover->wider > 1))
		return *s;
	float middle = 0.5f * (s->low + s->high), reach = 0.5f * cover->wider * (s->high - s->low);
	return span_of((double)(middle - reach), (double)(middle + reach), screen->columns);
}

static void cover_cells(const struct lod_screen *screen, const struct cover *cover, lod_f4 uncovered, lod_f4 *cells)
{
	lod_f4 one = lod_f4_all(1), covered = one - uncovered;
	for (int r = cover->v->crown.row; r < cover->v->crown.end; r++) {
		float height;
		struct span across = cover_run(screen, cover, r, &height);
		lod_f4 *row = cells + r * (int)screen->columns, part = covered * lod_f4_all(height);
		for (int c = across.first; c < across.end; c++)
			row[c] *= one - part * lod_f4_all(inside(&across, c));
	}
}

/* Layers of splats. The points of a summary are drawn at random from leaves of its plants, so splats lie on crowns by
 * chance, and reach beyond them: a point is in none with probability e^-layers (Poisson). */
static void add_splats(const struct lod_screen *screen, uint32_t index, const struct lod_splats *splats, float *layers)
{
	struct span across, down;
	const double all = box_around(screen, index, 1, splats->side, &across, &down) * screen->cell_x * screen->cell_y;
	const float each = all > 0 ? (float)(splats->count * splats->side * splats->side / all) : 0;
	for (int r = down.first; r < down.end; r++)
		for (int c = across.first; c < across.end; c++)
			layers[r * (int)screen->columns + c] += each * inside(&down, r) * inside(&across, c);
}

static void cover_all(const struct lod_screen *screen, lod_drawn_fn drawn_of, void *ctx, lod_f4 *cells, float *layers)
{
	for (uint32_t i = 0; i < screen->count; i++) {
		const struct lod_visibility *v = &screen->visibilities[i];
		if (v->crown.row == v->crown.end)
			continue;
		struct lod_drawn drawn = drawn_of(ctx, v);
		struct cover cover = cover_of(v);
		float clear = 1 - cover.shown;
		bool splats = drawn.splats.count > 0;
		cover_cells(screen, &cover, splats ? (lod_f4){ clear, 1, clear, 1 }
			: uncovered_of((double)cover.shown, drawn.wrong), cells);
		if (splats)
			add_splats(screen, i, &drawn.splats, layers);
	}
}

static struct eco_prediction sum_up(const struct lod_screen *screen, const lod_f4 *cells, const float *layers)
{
	double tp = 0, fp = 0, fn = 0, pixels = screen->cell_x * screen->cell_y;
	for (uint32_t i = 0; i < screen->columns * screen->rows; i++) {
		double through = layers[i] > 0 ? lod_exp_minus((double)layers[i]) : 1,
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
	float *layers = calloc(count, sizeof *layers);
	for (uint32_t i = 0; cells && i < count; i++)
		cells[i] = lod_f4_all(1);
	bool good = cells && layers;
	if (good) {
		cover_all(screen, drawn, ctx, cells, layers);
		*prediction = sum_up(screen, cells, layers);
	}
	free(cells);
	free(layers);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a screen of %u cells",
		count);
}
