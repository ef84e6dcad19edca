/* Drawing splats and impostors: see lod/splat.h and lod/impostor.h. Unlike the edges of triangles those of
 * ellipses are decided in single floats, by + - * / and square roots in a fixed order. */
#include "lod/impostor.h"
#include "lod/lanes.h"
#include "lod/leaf.h"
#include "lod/raster/raster_state.h"
#include "lod/splat.h"

/* The outline of a ball in the picture: an ellipse around (x, y), pixels from the picture's middle. */
struct outline { struct lod_ellipse ellipse; float x, y; };
struct disc {                        /* a projected splat */
	struct outline outline;
	float w, near_w, opacity;    /* w: metres away */
	uint32_t salt;
	float leaf;                  /* its width; 0: smooth */
	leaf_splat leaves;
};

static float row_of(const float row[4], const float p[3])
{
	return row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
}

/* Sets what follows from the centre, and x, y and depth per metre at it. */
static bool place(const struct lod_raster_state *state, const float centre[3], struct disc *disc, float at[2])
{
	const float (*m)[4] = state->clip;
	disc->w = row_of(m[2], centre) + m[2][3];
	disc->near_w = state->near_w;
	if (!(disc->w >= state->near_w))
		return false;
	for (int k = 0; k < 2; k++)
		at[k] = (row_of(m[k], centre) + m[k][3]) / disc->w;
	return fabsf(at[0]) < 1e30f && fabsf(at[1]) < 1e30f;
}

static bool project(const struct lod_raster_state *state, const float center[3], const float half[9],
	const float at[2], struct disc *disc)
{
	const float (*m)[4] = state->clip;
	float across[3], down[3], farther[3], pixel = 1.0f / LOD_SUBPIXEL / disc->w, near = 1 / disc->w;
	for (int k = 0; k < 3; k++) {
		farther[k] = row_of(m[2], half + 3 * k);
		across[k] = (row_of(m[0], half + 3 * k) - farther[k] * at[0]) * pixel;
		down[k] = (row_of(m[1], half + 3 * k) - farther[k] * at[1]) * pixel;
		farther[k] *= near;
	}
	if (!lod_ellipse_make(&disc->outline.ellipse, across, down, farther, disc->w))
		return false;
	if (disc->leaf > 0) {
		const struct lod_ellipse *e = &disc->outline.ellipse;
		float far = disc->w / (float)state->place.scale, drawn = fabsf(LOD_SUBPIXEL / state->project[1][1]);
		lod_leaf_splat(&disc->leaves, e, across, down, farther, disc->w, center, half, disc->leaf,
			sqrtf(e->half * e->high) * drawn * far, far * (float)state->eye.pixel_rad, disc->salt + state->salt);
		disc->leaves.opacity = disc->opacity;
	}
	return true;
}

/* The same for a ball: its half axes may be those of the view. */
static bool project_ball(const struct lod_raster_state *state, float radius, const float at[2],
	struct disc *disc)
{
	float pixel = radius * (1.0f / LOD_SUBPIXEL) / disc->w;
	const float across[3] = { state->project[0][0] * pixel, 0, (state->project[0][2] - at[0]) * pixel },
		down[3] = { 0, state->project[1][1] * pixel, (state->project[1][2] - at[1]) * pixel },
		farther[3] = { 0, 0, radius / disc->w };
	return lod_ellipse_make(&disc->outline.ellipse, across, down, farther, disc->w);
}

/* Puts the outline to where the centre is. */
static void put_outline(struct outline *o, const float at[2])
{
	o->x = at[0] * (1.0f / LOD_SUBPIXEL) + o->ellipse.x;
	o->y = at[1] * (1.0f / LOD_SUBPIXEL) + o->ellipse.y;
}

/* The first pixel whose centre is at or after `at` (from the picture's middle), clamped to [0, size]. */
static uint32_t first_pixel(float at, uint32_t size)
{
	at += 0.5f * (float)size - 0.5f;
	if (!(at > 0))
		return 0;
	if (!(at <= (float)size))
		return size;
	uint32_t whole = (uint32_t)at;
	return whole + ((float)whole < at);
}

/* The rows of an outline. */
static void outline_rows(const struct outline *o, const struct lod_raster *raster, uint32_t rows[2])
{
	rows[0] = first_pixel(o->y - o->ellipse.high, raster->height);
	rows[1] = first_pixel(o->y + o->ellipse.high, raster->height);
}

/* Its pixels [span[0], span[1]) of a row, which is *y below its middle; false: none. */
LOD_INLINE bool outline_span(const struct outline *o, const struct lod_raster *raster, uint32_t row, float *y,
	uint32_t span[2])
{
	*y = (float)row + 0.5f - 0.5f * (float)raster->height - o->y;
	float half = lod_ellipse_row(&o->ellipse, *y), x = o->x + o->ellipse.lean * *y;
	if (half < 0)
		return false;
	span[0] = first_pixel(x - half, raster->width);
	span[1] = first_pixel(x + half, raster->width);
	return span[0] < span[1];
}

/* The outline of a shell, whose radius has that square. */
static struct outline outline_grown(const struct outline *outline, float square)
{
	struct outline grown = *outline;
	grown.ellipse.high *= sqrtf(square);
	grown.ellipse.half *= sqrtf(square);
	grown.ellipse.wide *= sqrtf(square);
	return grown;
}

/* Whether its box is certainly behind what is drawn; of a silhouette, where all is covered. grown: the square
 * of the outermost shell's radius. */
static bool is_hidden(struct lod_raster *raster, const struct lod_paint *paint, const struct disc *disc,
	float grown)
{
	const struct outline o = outline_grown(&disc->outline, grown);
	const struct lod_ellipse *e = &o.ellipse;
	uint32_t columns[2] = { first_pixel(o.x - e->wide, raster->width),
		first_pixel(o.x + e->wide, raster->width) }, rows[2];
	float reach = sqrtf((e->aside * e->aside + e->below * e->below + e->bulge * e->bulge) * grown),
		w = disc->w - reach;
	outline_rows(&o, raster, rows);
	if (columns[0] == columns[1] || rows[0] == rows[1])
		return false;
	columns[1]--;
	rows[1]--;
	return lod_blocks_hide(raster, columns, rows, paint->silhouette ? INFINITY
		: 1.000001f / (w > disc->near_w ? w : disc->near_w));
}

LOD_INLINE float shell_depth(const struct disc *disc, uint32_t shell, float u, float v)
{
	const struct lod_ellipse *e = &disc->outline.ellipse;
	float w = disc->w + e->aside * u + e->below * v
		- e->bulge * sqrtf(lod_max(leaf_height2(disc->leaves, shell, u, v), 0));   /* its rim is rounded */
	return 1 / (w > disc->near_w ? w : disc->near_w);
}

/* Leaves in pixels [from, to) of a row. No cell is looked up where even the outermost shell is hidden; of a
 * silhouette without ground, where something is drawn already. */
LOD_INLINE void fill_leaf_row(const struct lod_paint *paint, const struct disc *disc, uint32_t row, float y,
	uint32_t from, uint32_t to)
{
	const struct lod_raster *raster = paint->raster;
	const struct lod_ellipse *e = &disc->outline.ellipse;
	float v = y / e->high;
	size_t first = (size_t)row * raster->width;
	bool any = false;
	for (uint32_t x = from; x < to; x++) {
		size_t i = first + x;
		if (paint->silhouette && raster->depth[i] == INFINITY)
			continue;
		float at = (float)x + 0.5f - 0.5f * (float)raster->width - disc->outline.x,
			u = e->half > 0 ? (at - e->lean * y) / e->half : 0;
		if (!paint->plain && !(shell_depth(disc, 1, u, v) >= raster->depth[i]))
			continue;
		uint32_t leaf = leaf_at(disc->leaves, u, v);
		if (!leaf)
			continue;
		float z = paint->plain ? 1 / disc->w : shell_depth(disc, leaf & 3, u, v);
		bool seen = lod_paint_pixel(paint, i, z);
		if (seen && raster->leaf)
			raster->leaf[i] = leaf;
		any |= seen;
	}
	if (any)
		lod_mark_stale(paint, row, from, to);
}

/* Leaves on it: rows of the outermost shell. Within the innermost one all cells are covered if it is opaque. */
LOD_CLONES static void fill_leaves(const struct lod_paint *paint, const struct disc *disc)
{
	const struct lod_raster *raster = paint->raster;
	float ragged = disc->leaves.ragged, y;
	struct outline outer = outline_grown(&disc->outline, 1 + ragged),
		inner = outline_grown(&disc->outline, 1 - ragged);
	bool whole = paint->silhouette && disc->opacity >= 1;
	uint32_t rows[2], span[2], in[2];
	outline_rows(&outer, raster, rows);
	rows[1] += rows[1] < raster->height;
	for (uint32_t row = rows[0]; row < rows[1]; row++) {
		if (!outline_span(&outer, raster, row, &y, span))
			continue;
		if (whole && outline_span(&inner, raster, row, &y, in)) {
			fill_leaf_row(paint, disc, row, y, span[0], in[0]);
			lod_fill_row(paint, row, in[0], in[1], 1 / disc->w);
			span[0] = in[1];
		}
		fill_leaf_row(paint, disc, row, y, span[0], span[1]);
	}
}

/* A silhouette may lie at the depth of the centre as a whole. */
static void fill_row(const struct lod_paint *paint, const struct disc *disc, uint32_t row, float y,
	uint32_t from, uint32_t to)
{
	if (disc->opacity >= 1 && paint->silhouette) {
		lod_fill_row(paint, row, from, to, 1 / disc->w);
		return;
	}
	bool any = false;
	size_t first = (size_t)row * paint->raster->width;
	float left = 0.5f - 0.5f * (float)paint->raster->width - disc->outline.x;
	for (uint32_t x = from; x < to; x++) {
		if (paint->silhouette && paint->raster->depth[first + x] == INFINITY)
			continue;
		if (disc->opacity < 1 && !lod_splat_covers(disc->salt, x, row, disc->opacity))
			continue;
		float w = disc->w + (paint->silhouette ? 0
			: lod_ellipse_farther(&disc->outline.ellipse, (float)x + left, y));
		any |= lod_paint_pixel(paint, first + x, 1 / (w > disc->near_w ? w : disc->near_w));
	}
	if (any)
		lod_mark_stale(paint, row, from, to);
}

static void fill_disc(const struct lod_paint *paint, const struct disc *disc)
{
	uint32_t rows[2], span[2];
	float y;
	outline_rows(&disc->outline, paint->raster, rows);
	rows[1] += rows[1] < paint->raster->height;
	for (uint32_t row = rows[0]; row < rows[1]; row++)
		if (outline_span(&disc->outline, paint->raster, row, &y, span))
			fill_row(paint, disc, row, y, span[0], span[1]);
}

void lod_raster_splats(struct lod_raster *raster, const struct lod_raster_batch *batch)
{
	const struct lod_raster_state *state = raster->state;
	struct lod_paint paint = lod_paint_make(raster, batch);
	float radius = (float)(sqrt((double)batch->area / 3.14159265358979) * state->place.scale);
	for (uint32_t i = 0; i < batch->count; i++) {
		const float *centre = batch->position + 3 * (size_t)i;
		struct disc disc = { .opacity = batch->opacity ? batch->opacity[i] : 1,
			.salt = lod_splat_salt(centre, state->eye.sample),
			.leaf = batch->wood && batch->wood[i] > 0 ? 0 : batch->leaf };
		float at[2], reach = batch->size ? radius * sqrtf(batch->size[i]) : radius,
			own = reach / (float)state->place.scale;
		const float ball[9] = { own, 0, 0, 0, own, 0, 0, 0, own };
		if (!place(state, centre, &disc, at) || !(batch->half || disc.leaf > 0
				? project(state, centre, batch->half ? batch->half + 9 * (size_t)i : ball, at, &disc)
				: project_ball(state, reach, at, &disc)))
			continue;
		put_outline(&disc.outline, at);
		if (is_hidden(raster, &paint, &disc, disc.leaf > 0 ? 1 + disc.leaves.ragged : 1))
			continue;
		paint.item = batch->item + i;
		if (disc.leaf > 0)
			fill_leaves(&paint, &disc);
		else
			fill_disc(&paint, &disc);
	}
}

/* ---- Impostors ---- */

/* Rays of pixels in plant space: middle + x across + y down, for pixels from the picture's middle; a metre of
 * depth long. */
struct rays { float middle[3], across[3], down[3]; };
/* Leaves on it: cells a metre and their amount, 0: none; how much of it they cover, and the salt of gaps
 * without leaves. */
struct leaves { float cells, amount, opacity; uint32_t nth, salt; };

/* A direction of the world in plant space, `scale` times as long. */
static void turn_back(const struct lod_place *place, const double d[3], double scale, double out[3])
{
	scale /= place->scale;
	out[0] = (d[0] * place->cosine + d[1] * place->sine) * (scale / lod_place_width(place));
	out[1] = (d[1] * place->cosine - d[0] * place->sine) * (scale / lod_place_width(place));
	out[2] = d[2] * scale;
}

static void rays_make(struct rays *rays, const struct lod_raster *raster)
{
	const struct lod_raster_state *state = raster->state;
	const struct lod_eye *eye = &state->eye;
	double across[3], down[3], middle[3], forward[3];
	turn_back(&state->place, eye->right, 2 * eye->tan_x / raster->width, across);
	turn_back(&state->place, eye->up, -2 * eye->tan_y / raster->height, down);
	for (int k = 0; k < 3; k++)
		middle[k] = eye->forward[k] + eye->middle[0] * eye->right[k] + eye->middle[1] * eye->up[k];
	turn_back(&state->place, middle, 1, forward);
	for (int k = 0; k < 3; k++) {
		rays->across[k] = (float)across[k];
		rays->down[k] = (float)down[k];
		rays->middle[k] = (float)forward[k];
	}
}

static void look_from(struct lod_impostor_look *look, const struct lod_impostor *impostor,
	const struct lod_raster_state *state)
{
	const struct lod_place *place = &state->place;
	double offset[3], at[3];
	float eye[3];
	for (int k = 0; k < 3; k++)
		offset[k] = state->eye.at[k] - place->at[k];
	turn_back(place, offset, 1, at);
	for (int k = 0; k < 3; k++)
		eye[k] = (float)(at[k] - (double)impostor->body.center[k]);
	lod_impostor_look(look, impostor, eye);
}

static uint32_t cell_where(const struct leaves *leaves, const struct lod_impostor *impostor,
	const float eye[3], const float ray[3], float along)
{
	float at[3];
	for (int k = 0; k < 3; k++)
		at[k] = (impostor->body.center[k] + eye[k] + along * ray[k]) * leaves->cells;
	return leaf_cell(at[0], at[1], at[2]);
}

static void fill_impostor_row(struct lod_paint *paint, uint32_t item, const struct lod_impostor *impostor,
	const struct lod_impostor_look *look, const struct rays *rays, const struct leaves *leaves,
	uint32_t row, uint32_t from, uint32_t to)
{
	const struct lod_raster *raster = paint->raster;
	float near_w = raster->state->near_w, y = (float)row + 0.5f - 0.5f * (float)raster->height;
	bool any = false;
	for (uint32_t column = from; column < to; column++) {
		float x = (float)column + 0.5f - 0.5f * (float)raster->width, ray[3];
		struct lod_impostor_hit hit;
		for (int k = 0; k < 3; k++)
			ray[k] = rays->middle[k] + y * rays->down[k] + x * rays->across[k];
		if (!lod_impostor_hit(impostor, look, ray, &hit))
			continue;
		size_t i = (size_t)row * raster->width + column;
		if (!(1 / (hit.along > near_w ? hit.along : near_w) >= raster->depth[i]))
			continue;
		uint32_t cell = leaves->amount > 0 ? cell_where(leaves, impostor, look->eye, ray, hit.along) : 0;
		float need = leaves->amount > 0 ? leaf_need(leaf_drawn(cell, leaves->amount, leaves->nth))
			: lod_splat_need(leaves->salt, column, row);
		if (!(need < leaves->opacity))
			continue;
		float along = hit.along + 2 * (hit.middle - hit.along) * LOD_IMPOSTOR_DEEP(need, leaves->opacity);
		paint->item = item + hit.cell;
		bool seen = lod_paint_pixel(paint, i, 1 / (along > near_w ? along : near_w));
		if (seen && raster->leaf && leaves->amount > 0)
			raster->leaf[i] = leaf_in(cell, leaves->amount);
		any |= seen;
	}
	if (any)
		lod_mark_stale(paint, row, from, to);
}

void lod_raster_impostor(struct lod_raster *raster, const struct lod_impostor *impostor,
	const struct lod_raster_batch *batch)
{
	const struct lod_raster_state *state = raster->state;
	struct lod_paint paint = lod_paint_make(raster, batch);
	struct lod_impostor_look look;
	struct rays rays;
	struct disc disc;
	uint32_t rows[2], span[2];
	float at[2], y;
	if (!place(state, impostor->body.center, &disc, at)
			|| !project_ball(state, (float)(impostor->radius * lod_place_most(&state->place)), at, &disc))
		return;
	put_outline(&disc.outline, at);
	rays_make(&rays, raster);
	look_from(&look, impostor, state);
	struct leaves leaves = { .opacity = impostor->opacity, .salt = lod_splat_salt(impostor->body.center, state->eye.sample) };
	leaves.nth = leaves.salt + state->salt;
	if (batch->leaf > 0) {
		float pixel = disc.w / (float)state->place.scale * (float)state->eye.pixel_rad;
		leaves.cells = 1 / (LOD_LEAF_LATTICE * lod_leaf_side(batch->leaf, pixel));
		leaves.amount = fminf(batch->leaf / pixel, 1);
	}
	outline_rows(&disc.outline, raster, rows);
	for (uint32_t row = rows[0]; row < rows[1]; row++)
		if (outline_span(&disc.outline, raster, row, &y, span))
			fill_impostor_row(&paint, batch->item, impostor, &look, &rays, &leaves, row, span[0], span[1]);
}
