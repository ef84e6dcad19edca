/* Shadow maps: where shadows are, against rays towards the sun; how fine they are near the eye; and the cases
 * in which the perspective map is singular. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_mesh.h"
#include "client-min/draw/view_shadow.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define MAP 2048u
#define FULL 0.9999f                    /* light, but for what floats round */

static int open_all(void **state)
{
	scene_open(state);
	scene_make_impostor(&grove, 300);
	return scene_open_gl(state);
}

/* ---- What is drawn and lit ---- */

struct lit {
	struct scene_held h;
	struct view_selection casters;
	struct view_picture picture;
};

static void draw_view(struct lit *l, struct eco_view view)
{
	l->h = scene_hold_view(&grove, view, 1);
	scene_select(&l->h);
	assert_good(view_select_casters(&l->casters, l->h.store, &l->h.eye, &cause));
	l->picture = scene_draw(&l->h, false, VIEW_TINT_NONE);
}

static void close_view(struct lit *l)
{
	view_picture_free(&l->picture);
	view_select_free(&l->casters);
	scene_release(&l->h);
}

static struct view_shadow_job job_of(const struct lit *l, const double sun[3], enum view_shadows kind)
{
	struct view_shadow_job job = { l->h.store, &l->casters, &l->h.eye, &l->picture, { 0 }, kind, MAP, 1 };
	double length = sqrt(lod_dot(sun, sun));
	for (int k = 0; k < 3; k++)
		job.sun[k] = (float)(sun[k] / length);
	return job;
}

static struct view_shadow cast(const struct view_shadow_job *job)
{
	struct view_shadow shadow;
	assert_good(view_shadow_make(&shadow, job, &cause));
	return shadow;
}

/* From the eye to what a pixel shows. */
static bool place_of(const struct lit *l, uint32_t x, uint32_t y, float to[3])
{
	const struct lod_eye *eye = &l->h.eye;
	float depth = l->picture.depth[(size_t)y * l->picture.width + x];
	double ray[3];
	view_picture_ray(&l->picture, eye, x, y, ray);
	for (int k = 0; k < 3; k++)
		to[k] = (float)(ray[k] / (double)depth);
	return depth > 0;
}

/* ---- The twin: rays ---- */

/* A triangle's corners, or a disc's middle and radius; from the eye. */
struct solid { double corner[3][3], radius; };
struct solids { struct solid *items; size_t count, room; };

static struct solid *add_solid(struct solids *s)
{
	if (s->count == s->room)
		s->items = realloc(s->items, (s->room = 2 * s->room + 64) * sizeof *s->items);
	s->items[s->count] = (struct solid){ .radius = 0 };
	return &s->items[s->count++];
}

static void put_corner(const struct lit *l, const struct lod_place *place, const float p[3], double out[3])
{
	lod_place_point(place, p, out);
	for (int k = 0; k < 3; k++)
		out[k] -= l->h.eye.at[k];
}

/* A line is as wide as it is, towards the sun. */
static void add_line(struct solids *s, double a[3], double b[3], double width, const double sun[3])
{
	double along[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] }, side[3];
	lod_cross(along, sun, side);
	double part = 0.5 * width / sqrt(fmax(lod_dot(side, side), 1e-30));
	for (int half = 0; half < 2; half++) {
		struct solid *t = add_solid(s);
		for (int k = 0; k < 3; k++) {
			t->corner[0][k] = a[k] + part * side[k];
			t->corner[1][k] = b[k] - part * side[k];
			t->corner[2][k] = half ? b[k] + part * side[k] : a[k] - part * side[k];
		}
	}
}

static void add_mesh(const struct lit *l, struct solids *s, const struct lod_place *place,
	const struct view_mesh *mesh, const double sun[3])
{
	const struct lod_geometry *g = &mesh->geometry;
	enum eco_list_kind kind = (enum eco_list_kind)mesh->list->list.kind;
	for (uint32_t i = 0; i < mesh->batch.count; i++) {
		if (kind == ECO_LIST_LINES) {
			double a[3], b[3];
			put_corner(l, place, g->position + 6 * i, a);
			put_corner(l, place, g->position + 6 * i + 3, b);
			add_line(s, a, b, (double)g->width[i] * place->scale, sun);
			continue;
		}
		struct solid *t = add_solid(s);
		int corners = kind == ECO_LIST_TRIANGLES ? 3 : 1;
		for (int c = 0; c < corners; c++)
			put_corner(l, place, g->position + 3 * ((size_t)corners * i + (size_t)c), t->corner[c]);
		t->radius = corners == 1 ? (double)view_mesh_reach(mesh, i) * place->scale : 0;
	}
}

static struct solids solids_of(const struct lit *l, const double sun[3])
{
	struct solids s = { NULL, 0, 0 };
	const struct view_selection *c = &l->casters;
	for (uint32_t cut = 0; cut < c->cut_count; cut++)
		for (uint32_t m = c->member_first[cut]; m < c->member_first[cut + 1]; m++) {
			const struct view_instance *p = &c->instances[c->members[m]];
			FREED(view_mesh) mesh = { .list = NULL };
			assert_int_equal(view_mesh_make(&mesh, l->h.store, &c->plan_cuts[cut],
				p->plant == ECO_NONE ? NULL : view_store_plant(l->h.store, p->plant), NULL), 0);
			add_mesh(l, &s, &p->place, &mesh, sun);
		}
	return s;
}

/* Möller and Trumbore 1997. */
static bool meets(const struct solid *t, const double from[3], const double sun[3], double least)
{
	double e1[3], e2[3], to[3], q[3], r[3];
	for (int k = 0; k < 3; k++) {
		e1[k] = t->corner[1][k] - t->corner[0][k];
		e2[k] = t->corner[2][k] - t->corner[0][k];
		to[k] = from[k] - t->corner[0][k];
	}
	if (t->radius > 0) {
		double along = -lod_dot(to, sun);
		return along > least && lod_dot(to, to) - along * along < t->radius * t->radius;
	}
	lod_cross(sun, e2, q);
	lod_cross(to, e1, r);
	double whole = lod_dot(e1, q), a = lod_dot(to, q) / whole, b = lod_dot(sun, r) / whole;
	return a >= 0 && b >= 0 && a + b <= 1 && lod_dot(e2, r) / whole > least;
}

static bool is_dark(const struct solids *s, const float to[3], const double sun[3])
{
	const double from[3] = { (double)to[0], (double)to[1], (double)to[2] };
	for (size_t i = 0; i < s->count; i++)
		if (meets(&s->items[i], from, sun, 0.05))
			return true;
	return false;
}

/* Ground is asked about: it casts no shadow on itself. */
static void compare_with_rays(const struct lit *l, const double towards[3], enum view_shadows kind,
	const char *name)
{
	struct view_shadow_job job = job_of(l, towards, kind);
	job.threads = kind == VIEW_SHADOWS_STANDARD ? 1 : 5;
	struct view_shadow shadow = cast(&job);
	const double sun[3] = { (double)job.sun[0], (double)job.sun[1], (double)job.sun[2] };
	struct solids s = solids_of(l, sun);
	uint32_t sure = 0, wrong = 0, dark = 0, unsure = 0;
	assert_non_null(shadow.top);
	for (uint32_t y = 0; y < l->picture.height; y += 9)
		for (uint32_t x = 0; x < l->picture.width; x += 9) {
			float to[3], texel_m, lit;
			if (l->picture.owner[(size_t)y * l->picture.width + x] || !place_of(l, x, y, to))
				continue;
			lit = view_shadow_lit(&shadow, to, (const float[3]){ 0, 0, 1 }, &texel_m);
			if (lit < 0)
				continue;
			bool expected = is_dark(&s, to, sun);
			unsure += lit > 0 && lit < FULL;
			sure += lit == 0 || lit > FULL;
			dark += expected;
			wrong += (lit == 0 && !expected) || (lit > FULL && expected);
		}
	print_message("%s, %s: %u of %u places wrong, %u on edges, %u dark\n", name,
		kind == VIEW_SHADOWS_STANDARD ? "standard" : "perspective", wrong, sure, unsure, dark);
	assert_true(sure > 300 && dark > 20);
	assert_true(wrong * 50 <= sure);
	free(s.items);
	view_shadow_free(&shadow);
}

/* Named by where the sun is for who looks. */
static const struct { const char *name; double forward, right, up; } suns[] = { { "beside", 0, 1, 1 },
	{ "behind", -1, 0.2, 0.6 }, { "ahead", 1, 0.3, 0.7 }, { "behind, in line", -1, 0, 0.25 },
	{ "low ahead", 1, 0.1, 0.2 }, { "overhead", 0, 0, 1 } };

static void find_sun(const struct lit *l, size_t i, double sun[3])
{
	const struct lod_eye *eye = &l->h.eye;
	double size = hypot(eye->forward[0], eye->forward[1]);
	for (int k = 0; k < 2; k++)
		sun[k] = suns[i].forward * eye->forward[k] / size + suns[i].right * eye->right[k];
	sun[2] = suns[i].up;
}

UNIT_TEST(shadows_are_where_rays_to_the_sun_meet_something)
{
	struct lit l;
	draw_view(&l, scene_view());
	for (size_t i = 0; i < sizeof suns / sizeof *suns; i++) {
		double sun[3];
		find_sun(&l, i, sun);
		compare_with_rays(&l, sun, VIEW_SHADOWS_STANDARD, suns[i].name);
		compare_with_rays(&l, sun, VIEW_SHADOWS_PERSPECTIVE, suns[i].name);
	}
	close_view(&l);
}

/* ---- Texels ---- */

/* Someone who stands under trees: the nearest ground is near, the farthest plants are far. */
static struct eco_view standing(void)
{
	return (struct eco_view){ { -9, -11, 1.2 }, { 0, 4, 1.0 }, { 0, 0, 1 }, 60, 480, 320 };
}

UNIT_TEST(perspective_has_more_texels_near_the_eye)
{
	struct lit l;
	draw_view(&l, standing());
	for (size_t i = 0; i < sizeof suns / sizeof *suns; i++) {
		double sun[3], texels[3];
		find_sun(&l, i, sun);
		for (int kind = VIEW_SHADOWS_STANDARD; kind <= VIEW_SHADOWS_PERSPECTIVE; kind++) {
			struct view_shadow_job job = job_of(&l, sun, (enum view_shadows)kind);
			FREED(view_shadow) shadow = cast(&job);
			texels[kind] = view_shadow_sharpness(&shadow, &l.picture, &l.h.eye);
		}
		print_message("%s: texels a pixel near the eye: standard %.2f, perspective %.2f\n",
			suns[i].name, texels[1], texels[2]);
		assert_true(texels[1] > 0 && texels[2] >= 0.85 * texels[1]);
		if (strcmp(suns[i].name, "beside") == 0 || strcmp(suns[i].name, "overhead") == 0)
			assert_true(texels[2] > 2 * texels[1]);
	}
	close_view(&l);
}

/* All that is seen lies in the map, wherever the sun is: W never reaches 0 there. */
UNIT_TEST(what_is_seen_lies_in_the_map)
{
	struct lit l;
	draw_view(&l, standing());
	for (int turn = 0; turn < 24; turn++)
		for (int rise = 1; rise < 10; rise += 2)
			for (int kind = VIEW_SHADOWS_STANDARD; kind <= VIEW_SHADOWS_PERSPECTIVE; kind++) {
				double angle = turn * 0.2618, up = rise * 0.17;
				const double sun[3] = { cos(angle) * cos(up), sin(angle) * cos(up), sin(up) };
				struct view_shadow_job job = job_of(&l, sun, (enum view_shadows)kind);
				uint32_t seen = 0, in = 0;
				job.size = 64;
				struct view_shadow shadow = cast(&job);
				for (size_t i = 0; i < (size_t)l.picture.width * l.picture.height; i += 37) {
					float to[3], texel[2];
					if (!l.picture.owner[i] || !place_of(&l, (uint32_t)(i % l.picture.width),
							(uint32_t)(i / l.picture.width), to))
						continue;
					seen++;
					in += view_shadow_place(&shadow, to, texel);
				}
				assert_true(seen > 300 && in == seen);
				view_shadow_free(&shadow);
			}
	close_view(&l);
}

/* ---- Casters ---- */

static uint32_t dark_places(const struct lit *l, const struct view_shadow_job *job)
{
	FREED(view_shadow) shadow = cast(job);
	uint32_t dark = 0;
	for (uint32_t y = 0; y < l->picture.height; y += 3)
		for (uint32_t x = 0; x < l->picture.width; x += 3) {
			float to[3], texel_m;
			if (!l->picture.owner[(size_t)y * l->picture.width + x] && place_of(l, x, y, to))
				dark += view_shadow_lit(&shadow, to, (const float[3]){ 0, 0, 1 }, &texel_m) == 0;
		}
	return dark;
}

/* With the back to the trees and to a low sun, their shadows lie ahead. */
UNIT_TEST(plants_out_of_sight_cast_shadows)
{
	struct eco_view away = { { -12, -13, 3 }, { -24, -25, 0 }, { 0, 0, 1 }, 60, 480, 320 };
	struct lit l;
	draw_view(&l, away);
	const double sun[3] = { 0.6, 0.6, 0.25 };
	struct view_shadow_job job = job_of(&l, sun, VIEW_SHADOWS_PERSPECTIVE);
	uint32_t all = dark_places(&l, &job);
	assert_true(l.casters.instance_count > l.h.selection.instance_count);
	job.casters = &l.h.selection;
	uint32_t seen = dark_places(&l, &job);
	print_message("dark places: %u with plants out of sight, %u without\n", all, seen);
	assert_true(all > 50 && all > 2 * seen);
	close_view(&l);
}

/* Without cuts of its crown, a near tree casts as a far one too. */
UNIT_TEST(a_plant_whose_cells_are_not_held_casts_as_a_whole)
{
	uint32_t near = 0, as_far = 0;
	for (int held = 1; held >= 0; held--) {
		struct scene_held h = { .view = standing() };
		struct view_selection casters;
		lod_eye_make(&h.eye, &h.view);
		scene_plan(&grove, &h.view, 1, &h.plan);
		uint32_t kept = 0;
		for (uint32_t i = 0; i < h.plan.cut_count; i++)
			if (held || h.plan.cuts[i].anchor != A_HIGH)
				h.plan.cuts[kept++] = h.plan.cuts[i];
		h.plan.cut_count = kept;
		h.store = scene_store(&grove, &h.plan, &cause);
		assert_good(view_select_casters(&casters, h.store, &h.eye, &cause));
		for (uint32_t i = 0; i < casters.instance_count; i++) {
			bool low = false, far = false;
			for (uint32_t c = casters.cut_first[i]; c < casters.cut_first[i + 1]; c++) {
				const struct eco_cut *cut = &casters.plan_cuts[casters.cuts[c]];
				low |= cut->anchor == A_LOW;
				far |= cut->list == L_POINTS;
			}
			near += held && low;
			as_far += low && far;
		}
		assert_int_equal(as_far, held ? 0 : near);
		view_select_free(&casters);
		scene_release(&h);
	}
	assert_true(near > 3);
}

/* ---- Maps by OpenGL ---- */

/* One cut of what casts. */
static struct view_selection only(const struct view_selection *all, uint32_t cut)
{
	struct view_selection one = *all;
	one.plan_cuts += cut;
	one.member_first += cut;
	one.cut_count = 1;
	return one;
}

UNIT_TEST(opengl_casts_the_same_shadows)
{
	struct lit l;
	if (!scene_gl)
		skip();
	draw_view(&l, standing());
	for (size_t i = 0; i < sizeof suns / sizeof *suns; i++)
		for (int kind = VIEW_SHADOWS_STANDARD; kind <= VIEW_SHADOWS_PERSPECTIVE; kind++) {
			double sun[3];
			find_sun(&l, i, sun);
			struct view_shadow_job job = job_of(&l, sun, (enum view_shadows)kind);
			assert_true(shadow_gl_compare(scene_gl, &job, suns[i].name) > 10000);
		}
	for (uint32_t cut = 0; cut < l.casters.cut_count; cut++) {
		struct view_selection one = only(&l.casters, cut);
		char name[64];
		double sun[3];
		find_sun(&l, 0, sun);
		struct view_shadow_job job = job_of(&l, sun, VIEW_SHADOWS_PERSPECTIVE);
		job.casters = &one;
		snprintf(name, sizeof name, "list %u", one.plan_cuts->list);
		shadow_gl_compare(scene_gl, &job, name);
	}
	close_view(&l);
}

/* ---- No map ---- */

UNIT_TEST(no_map_without_a_sun_or_anything_seen)
{
	struct lit l;
	draw_view(&l, scene_view());
	const double set[3] = { 0.9, 0.3, -0.3 }, up[3] = { 0, 0, 1 };
	struct view_shadow_job job = job_of(&l, set, VIEW_SHADOWS_PERSPECTIVE);
	struct view_shadow shadow = cast(&job);
	float to[3] = { 1, 2, -3 }, texel[2], texel_m;
	assert_null(shadow.top);
	assert_false(view_shadow_place(&shadow, to, texel));
	assert_true(view_shadow_lit(&shadow, to, NULL, &texel_m) == -1);
	memset(l.picture.depth, 0, sizeof(float) * l.picture.width * l.picture.height);
	job = job_of(&l, up, VIEW_SHADOWS_STANDARD);
	shadow = cast(&job);
	assert_null(shadow.top);
	assert_true(isnan(view_shadow_sharpness(&shadow, &l.picture, &l.h.eye)));
	close_view(&l);
}

UNIT_MAIN(open_all, scene_close)
