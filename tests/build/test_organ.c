/* Wood, foliage and flowers by shape and colour. */
#include <stdio.h>

#include "lod/build/organ/organ.h"
#include "lod/build/organ/organ_state.h"
#include "tests/support/cases.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static struct lod_arena arena;

/* Made by the test under way, until finish. */
static struct soup soup;
static struct { struct lod_mesh mesh; struct lod_organs organs; } found;

static void find(void)
{
	lod_weld(&found.mesh, &soup.model, 14, &arena);
	lod_organs_find(&found.organs, &found.mesh, &soup.model, &arena);
}

/* Organ of all components of `material`, which agree. */
static int organ_of(uint32_t material)
{
	int organ = -1;
	for (uint32_t c = 0; c < found.mesh.component_count; c++)
		if (found.organs.components[c].material == material) {
			assert_true(organ < 0 || organ == found.organs.components[c].organ);
			organ = found.organs.components[c].organ;
		}
	return organ;
}

static void finish(void)
{
	lod_arena_free(&arena);
	soup_free(&soup);
}

UNIT_TEST(tubes_are_measured_by_their_curvature)
{
	soup_begin(&soup);
	soup_tube(&soup, soup_material(&soup, 100, 70, 40, ECO_NONE, false), (struct lod_v3){ 0, 0, 0 },
		(struct lod_v3){ 1, 1, 4 }, 0.1, 0.1, 16, 20);
	for (uint32_t i = 0; i < soup.model.triangle_count; i += 3) {        /* winding must not matter */
		uint32_t swap = soup.model.index[3 * i];
		soup.model.index[3 * i] = soup.model.index[3 * i + 1];
		soup.model.index[3 * i + 1] = swap;
	}
	find();
	const struct lod_component *c = &found.organs.components[0];
	assert_true(fabs(c->radius - 0.1) < 0.003);
	assert_true(fabs(c->length - sqrt(18)) < 0.02);
	assert_int_equal(c->organ, ECO_ORGAN_WOOD);
	finish();
}

/* One material and no colours: lumps on a thinner trunk are its crown. */
UNIT_TEST(wood_grows_no_thicker_upwards)
{
	soup_begin(&soup);
	uint32_t one = soup_material(&soup, 231, 231, 231, ECO_NONE, false);
	soup_tube(&soup, one, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 4 }, 0.1, 0.1, 8, 6);
	soup_ball(&soup, one, (struct lod_v3){ 0, 0, 4.5 }, 1.2, 8);
	soup_ball(&soup, one, (struct lod_v3){ 0.8, 0, 3.5 }, 0.7, 8);
	find();
	for (uint32_t c = 0; c < found.mesh.component_count; c++) {
		const struct lod_component *b = &found.organs.components[c];
		assert_int_equal(b->organ, b->low[2] < 0.1 ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE);
	}
	finish();
}

UNIT_TEST(cut_outs_are_never_wood_but_an_atlas_may_hold_bark)
{
	soup_begin(&soup);
	uint32_t image = soup_disc_image(&soup, 16), leaf = soup_material(&soup, 255, 255, 255, image, true);
	uint32_t bark = soup_material(&soup, 255, 255, 255, image, true);
	soup_tube(&soup, leaf, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 5 }, 0.1, 0.05, 8, 10);
	uint32_t first = soup.model.vertex_count;
	soup_tube(&soup, bark, (struct lod_v3){ 2, 0, 0 }, (struct lod_v3){ 2, 0, 5 }, 0.1, 0.05, 8, 10);
	for (uint32_t i = 2 * first; i < 2 * soup.model.vertex_count; i++)
		soup.model.uv[i] = 0.4F + 0.05F * soup.model.uv[i];          /* the middle of the disc */
	find();
	assert_int_equal(organ_of(leaf), ECO_ORGAN_FOLIAGE);
	assert_int_equal(organ_of(bark), ECO_ORGAN_WOOD);
	finish();
}

UNIT_TEST(a_patch_inlaid_in_bark_is_bark)
{
	soup_tree(&soup, 50, 0, false);
	uint32_t dark = soup_material(&soup, 10, 10, 10, ECO_NONE, false);
	soup.model.material[20] = soup.model.material[21] = dark;
	find();
	assert_int_equal(organ_of(dark), ECO_ORGAN_WOOD);
	finish();
}

/* ---- Made plants: what they are made of, and what that is ---- */

static uint32_t named(struct soup *s, const char *name, uint8_t r, uint8_t g, uint8_t b)
{
	uint32_t m = soup_material(s, r, g, b, ECO_NONE, false);
	strncpy(s->material[m].name, name, sizeof s->material[m].name - 1);
	return m;
}

/* A closed box; `size` along x, y, z. */
static void box(struct soup *s, uint32_t material, struct lod_v3 at, struct lod_v3 size)
{
	static const uint8_t face[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
		{ 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
	uint32_t first = s->model.vertex_count;
	for (int i = 0; i < 8; i++)
		soup_vertex(s,
			lod_v3_add(at,
			(struct lod_v3){ i & 1 ? size.x / 2 : -size.x / 2, i & 2 ? size.y / 2 : -size.y / 2,
			i & 4 ? size.z : 0 }), 0, 0);
	for (int f = 0; f < 6; f++) {
		soup_triangle(s, material, first + face[f][0], first + face[f][1], first + face[f][2]);
		soup_triangle(s, material, first + face[f][0], first + face[f][2], first + face[f][3]);
	}
}

/* A bent strip of `n` quads from `at` along `d`, sinking at the end. */
static void frond(struct soup *s, uint32_t material, struct lod_v3 at, struct lod_v3 d, double width, int n)
{
	struct lod_v3 across = lod_v3_scale(lod_v3_unit(lod_v3_cross(d, (struct lod_v3){ 0, 0, 1 })),
		width / 2);
	uint32_t first = s->model.vertex_count;
	for (int i = 0; i <= n; i++) {
		double w = (double)i / n;
		struct lod_v3 p =
			lod_v3_add(at,
			lod_v3_add(lod_v3_scale(d, w),
			(struct lod_v3){ 0, 0, -0.6 * w * w * lod_v3_length(d) }));
		soup_vertex(s, lod_v3_add(p, across), 0, 0);
		soup_vertex(s, lod_v3_sub(p, across), 0, 0);
	}
	for (int i = 0; i < n; i++) {
		uint32_t a = first + 2 * (uint32_t)i;
		soup_triangle(s, material, a, a + 1, a + 3);
		soup_triangle(s, material, a, a + 3, a + 2);
	}
}

/* Branches that hang together: tubes that share their first vertex with the trunk's last ring. */
static void bare_tree(struct soup *s, uint32_t material)
{
	soup_tube(s, material, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 3 }, 0.15, 0.1, 8, 8);
	for (int i = 0; i < 12; i++) {
		struct lod_v3 d = soup_direction(s);
		d.z = fabs(d.z) + 0.3;
		soup_tube(s, material, (struct lod_v3){ 0, 0, 1.5 + 0.12 * i },
			lod_v3_add((struct lod_v3){ 0, 0, 2 }, lod_v3_scale(d, 2)), 0.04, 0.01, 5, 8);
	}
}

/* As tests/build/cases/organs.tsv says. */
enum kind { TUBE = 1, TWINE, BALL, LEAVES, BOX, QUAD, FRONDS, POT, DISC, BARE };
struct part {
	enum kind kind;
	uint32_t material;
	struct lod_v3 at, to;            /* or size */
	double first, last;
	uint32_t around, along, pieces;
};

static void part_make(struct soup *s, const struct part *p)
{
	/* walls: outside up, inside down, and bottoms; open on top */
	static const double pot[6][2] = { { 0, 0 }, { 0.7, 0 }, { 1, 1 }, { 0.9, 1 }, { 0.6, 0.1 }, { 0, 0.1 } };
	uint32_t pieces = p->pieces ? p->pieces : 1;
	struct lod_v3 step = lod_v3_scale(lod_v3_sub(p->to, p->at), 1.0 / pieces);
	for (uint32_t i = 0; i < pieces; i++) {
		double turn = 2 * LOD_PI * i / pieces, half = 0.5 * i;
		struct lod_v3 at = lod_v3_add(p->at, lod_v3_scale(step, i));
		if (p->kind == TUBE)
			soup_tube(s, p->material, at, lod_v3_add(at, step), p->first, p->last, p->around, p->along);
		else if (p->kind == TWINE)
			soup_tube(s, p->material, (struct lod_v3){ 0.3 * cos(half), 0.3 * sin(half), 0.3 * half },
				(struct lod_v3){ 0.3 * cos(half + 0.5), 0.3 * sin(half + 0.5), 0.3 * half + 0.15 },
				p->first, p->last, p->around, p->along);
		else if (p->kind == BALL)
			soup_ball(s, p->material, p->at, p->first, p->around);
		else if (p->kind == LEAVES)
			soup_leaves(s, p->material, p->around, p->at, p->first, p->last);
		else if (p->kind == BOX)
			box(s, p->material, lod_v3_add(p->at, (struct lod_v3){ i * p->first, 0, i * p->last }), p->to);
		else if (p->kind == QUAD)
			soup_quad(s, p->material, p->at, (struct lod_v3){ p->to.x, 0, 0 },
				(struct lod_v3){ 0, p->to.y, 0 });
		else if (p->kind == FRONDS)
			frond(s, p->material, p->at, (struct lod_v3){ p->to.x * cos(turn), p->to.x * sin(turn),
				p->to.z }, p->first, (int)p->along);
		else if (p->kind == POT)
			soup_turned(s, p->material, 0, p->first, p->last, pot, 6, 16);
		else if (p->kind == DISC)
			soup_turned(s, p->material, p->at.z, p->first, 1, (const double[][2]){ { 0, 0 }, { 1, 0 } }, 2, 16);
		else
			bare_tree(s, p->material);
	}
}

/* Organs of the materials that it makes. */
static void make_materials(struct soup *s, const char *text, int organs[4])
{
	char organ[16], name[32];
	unsigned rgb;
	for (int m = 0; text; m++, text = strchr(text, ';') ? strchr(text, ';') + 1 : NULL) {
		name[0] = 0;
		assert_true(sscanf(text, "%15[a-z] %x %31[^;]", organ, &rgb, name) >= 2);
		named(s, name, (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb);
		for (organs[m] = 0; strcmp(eco_organ_names[organs[m]], organ) != 0;)
			organs[m]++;
	}
}

static void make_parts(struct soup *s, const char *text)
{
	static const char *const kinds[] = { "", "tube", "twine", "ball", "leaves", "box", "quad", "fronds", "pot", "disc", "bare", NULL };
	for (; text; text = strchr(text, ';') ? strchr(text, ';') + 1 : NULL) {
		struct part p;
		char kind[16];
		assert_int_equal(sscanf(text, "%15[a-z] %u %lf %lf %lf %lf %lf %lf %lf %lf %u %u %u", kind, &p.material, &p.at.x, &p.at.y,
			&p.at.z, &p.to.x, &p.to.y, &p.to.z, &p.first, &p.last, &p.around, &p.along, &p.pieces), 13);
		p.kind = (enum kind)cases_choice(kind, kinds);
		part_make(s, &p);
	}
}

UNIT_TEST(plants_are_what_they_look_like)
{
	struct row { const char *name, *materials, *parts; uint32_t times; double apart; };
	uint32_t wrong = 0, count;
	const struct row *plants = cases_rows("tests/build/cases/organs.tsv", "sssud", sizeof *plants, &count);
	for (size_t i = 0; i < count; i++) {
		int organs[4];
		soup_begin(&soup);
		make_materials(&soup, plants[i].materials, organs);
		for (uint32_t n = 0; n < plants[i].times; n++) {
			uint32_t first = soup.model.vertex_count;
			make_parts(&soup, plants[i].parts);
			for (uint32_t v = first; v < soup.model.vertex_count; v++)
				soup.model.position[3 * v] += (float)(n * plants[i].apart);
		}
		find();
		for (uint32_t c = 0; c < found.mesh.component_count; c++) {
			const struct lod_component *part = &found.organs.components[c];
			if (part->organ == organs[part->material])
				continue;
			print_error("%s: a component of material %u, %u triangles, is %s\n", plants[i].name,
				part->material, part->triangle_count, eco_organ_names[part->organ]);
			wrong++;
		}
		finish();
	}
	assert_int_equal(wrong, 0);
}

static double organ_area(int organ)
{
	double area = 0;
	for (uint32_t c = 0; c < found.mesh.component_count; c++)
		area += found.organs.components[c].organ == organ ? found.organs.components[c].area : 0;
	return area;
}

/* One mesh, one material: leaves share a corner with the twig that they sit on. */
UNIT_TEST(leaves_welded_to_twigs_are_foliage)
{
	soup_begin(&soup);
	uint32_t m = named(&soup, "", 153, 153, 153), twig = soup.model.vertex_count;
	double leaf_area = 0;
	soup_tube(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 5 }, 0.05, 0.03, 6, 60);
	for (uint32_t i = 0; i < 200; i++) {
		uint32_t foot = twig + 6 + i;
		struct lod_v3 p = lod_v3_of(soup.model.position + 3 * foot),
			d = lod_v3_scale(soup_direction(&soup), 0.2);
		struct lod_v3 u = lod_v3_scale(lod_v3_unit(lod_v3_cross(d, soup_direction(&soup))), 0.1);
		uint32_t a = soup_vertex(&soup, lod_v3_add(p, lod_v3_add(d, u)), 0, 0),
			b = soup_vertex(&soup, lod_v3_add(p, lod_v3_sub(d, u)), 0, 0);
		soup_triangle(&soup, m, foot, a, b);
		leaf_area += 0.02;
	}
	find();
	assert_true(fabs(organ_area(ECO_ORGAN_FOLIAGE) / leaf_area - 1) < 0.02);
	assert_true(organ_area(ECO_ORGAN_WOOD) > 1.1);
	finish();
}

/* One material, whose image is a palette of a bark's brown and a leaf's green. */
static uint32_t palette_begin(void)
{
	static const uint8_t pixels[2][4] = { { 150, 75, 40, 255 }, { 60, 120, 50, 255 } };
	soup_begin(&soup);
	soup.image[0] = (struct eco_image){ 2, 1, malloc(sizeof pixels) };
	memcpy(soup.image[0].rgba, pixels, sizeof pixels);
	soup.model.image_count = 1;
	return soup_material(&soup, 255, 255, 255, 0, false);
}

/* All vertices from `first` on. */
static void palette_paint(uint32_t first, bool green)
{
	for (uint32_t i = first; i < soup.model.vertex_count; i++) {
		soup.model.uv[2 * i] = green ? 0.75f : 0.25f;
		soup.model.uv[2 * i + 1] = 0.5f;
	}
}

/* Trunk and crown are one surface; only the texture, a palette of two flat colours, tells them apart. */
UNIT_TEST(a_palette_texture_parts_trunk_and_crown)
{
	double ring[25][2];
	for (uint32_t i = 0; i < 25; i++) {          /* a stem, then a ball on it */
		double t = i / 12.0 - 1;
		ring[i][0] = i <= 12 ? 0.1 : 0.1 + 1.2 * sqrt(fmax(0, t * (1 - t)) * 4);
		ring[i][1] = 0.2 * i;
	}
	soup_turned(&soup, palette_begin(), 0, 1, 1, (const double (*)[2])ring, 25, 8);
	palette_paint(0, false);
	palette_paint(12 * 8, true);
	find();
	assert_true(fabs(organ_area(ECO_ORGAN_WOOD) - 2 * LOD_PI * 0.1 * 2.4) < 0.2);
	assert_true(organ_area(ECO_ORGAN_FOLIAGE) > 6);
	finish();
}

/* Low-poly trees: what is clear wood, or stands on the ground, speaks for the brown parts alone. */
UNIT_TEST(colours_of_a_palette_speak_for_themselves)
{
	for (int stout = 0; stout < 2; stout++) {
		uint32_t m = palette_begin();
		soup_tube(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 3 },
			stout ? 0.5 : 0.08, stout ? 0.4 : 0.05, 8, 8);
		soup_tube(&soup, m, (struct lod_v3){ 0, 0, 1.4 }, (struct lod_v3){ 1.2, 0, 1.8 },
			stout ? 0.2 : 0.04, stout ? 0.15 : 0.03, 8, 4);
		palette_paint(0, false);
		uint32_t wood = soup.model.triangle_count, crown = soup.model.vertex_count;
		soup_ball(&soup, m, (struct lod_v3){ 0, 0, 4 }, 1.4, 8);
		soup_ball(&soup, m, (struct lod_v3){ 1.5, 0, 2.2 }, 0.45, 6);
		soup_ball(&soup, m, (struct lod_v3){ -1.2, 0.2, 2.6 }, 0.4, 6);
		palette_paint(crown, true);
		find();
		for (uint32_t t = 0; t < found.mesh.triangle_count; t++)
			assert_int_equal(found.organs.components[found.mesh.component[t]].organ,
				found.mesh.source[t] < wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE);
		finish();
	}
}

/* An import makes a material of each colour: same name, no image. */
UNIT_TEST(vertex_colours_do_not_shatter_a_trunk)
{
	soup_begin(&soup);
	for (uint8_t i = 0; i < 6; i++)
		named(&soup, "scan", (uint8_t)(90 + 10 * i), (uint8_t)(80 + 9 * i), (uint8_t)(60 + 8 * i));
	bare_tree(&soup, 0);
	for (uint32_t t = 0; t < soup.model.triangle_count; t++)
		soup.model.material[t] = (uint32_t)(lod_mix(t) % 6);
	find();
	assert_int_equal(found.mesh.component_count, 13);
	assert_true(organ_area(ECO_ORGAN_FOLIAGE) == 0);
	finish();
}

UNIT_TEST(what_has_no_colour_has_that_of_its_organ)
{
	soup_tree(&soup, 400, 0, false);
	for (uint32_t i = 0; i < soup.model.material_count; i++) {
		memset(soup.model.materials[i].rgb, 153, 3);
		soup.model.materials[i].colourless = true;
	}
	find();
	for (uint32_t t = 0; t < found.mesh.triangle_count; t++) {
		const uint8_t *rgb = found.organs.rgb[t];
		bool wood = found.organs.components[found.mesh.component[t]].organ == ECO_ORGAN_WOOD;
		assert_true(wood ? rgb[0] > rgb[1] && rgb[1] > rgb[2] : rgb[1] > rgb[0] && rgb[1] > rgb[2]);
	}
	finish();
}

UNIT_TEST(rules_win_over_everything)
{
	soup_tree(&soup, 200, 0, false);
	uint32_t n = soup.model.triangle_count, trunk = 0;
	FREED_MEMORY uint8_t *organ = malloc(n);
	memset(organ, ECO_ORGAN_FOUND, n);
	while (soup.model.material[trunk] == 0 && trunk < 8 * 24 * 2)
		organ[trunk++] = ECO_ORGAN_FLOWER;
	for (uint32_t t = 0; t < n; t++)
		if (soup.model.material[t] == 1)
			organ[t] = t % 4 < 2 ? ECO_ORGAN_WOOD : ECO_ORGAN_FOUND;
	soup.model.organ = organ;
	find();
	for (uint32_t t = 0; t < found.mesh.triangle_count; t++) {
		uint8_t rule = organ[found.mesh.source[t]],
			is = found.organs.components[found.mesh.component[t]].organ;
		assert_int_equal(is, rule != ECO_ORGAN_FOUND ? rule
			: soup.model.material[found.mesh.source[t]] == 0 ? ECO_ORGAN_WOOD
			: ECO_ORGAN_FOLIAGE);
	}
	finish();
}

UNIT_TEST(names_hint_in_many_languages)
{
	static const char *const hints[] = { "none", "wood", "foliage", "flower", NULL };
	struct row { const char *name, *hint; };
	uint32_t count;
	const struct row *names = cases_read("tests/build/cases/hints.tsv", sizeof *names, &count);
	for (size_t i = 0; i < count; i++)
		if ((int)lod_name_hint(names[i].name) != cases_choice(names[i].hint, hints))
			fail_msg("%s hints at %d", names[i].name, lod_name_hint(names[i].name));
}
