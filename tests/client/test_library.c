/* libecostream: from a pack to counts and bytes, and from bytes to what is drawn; and that nothing impossible
 * goes through. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/library/ecostream.h"
#include "tests/support/files.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define PATH "build/tmp/library.eco"

static struct ecostream_pack *pack;

static struct ecostream_request request_of(uint64_t vertices)
{
	return (struct ecostream_request){ .eye = { 0, -150, 60 }, .target = { 0, 0, 2 }, .up = { 0, 0, 1 },
		.fov_y_deg = 50, .width = 640, .height = 480, .vertices = vertices };
}

static int open_pack(void **state)
{
	struct eco_error made = { 0 };
	struct ecostream_error error = { 0 };
	folder_make("build/tmp");
	remove(PATH);
	assert_ok(sample_pack_write(PATH, &made), made);
	assert_ok(ecostream_pack_open(&pack, PATH, &error), error);
	return 0;
}

static int close_pack(void **state)
{
	ecostream_pack_close(pack);
	remove(PATH);
	return 0;
}

static struct ecostream_answer *answer_to(const struct ecostream_request *request,
	struct ecostream_counts *counts)
{
	struct ecostream_error error = { 0 };
	struct ecostream_answer *answer;
	assert_ok(ecostream_plan(&answer, pack, request, &error), error);
	ecostream_answer_counts(answer, counts);
	return answer;
}

struct body { uint8_t *bytes; size_t size, room; };

static int append(void *context, const void *bytes, size_t size)
{
	struct body *body = context;
	if (size > body->room - body->size)
		return 1;
	memcpy(body->bytes + body->size, bytes, size);
	body->size += size;
	return 0;
}

static struct body body_of(const struct ecostream_request *request, struct ecostream_counts *counts)
{
	struct ecostream_error error = { 0 };
	struct ecostream_answer *answer = answer_to(request, counts);
	struct body body = { malloc(counts->bytes), 0, counts->bytes };
	assert_ok(ecostream_encode(answer, append, &body, &error), error);
	assert_int_equal(body.size, counts->bytes);
	ecostream_answer_free(answer);
	return body;
}

static enum ecostream_code feed(struct ecostream_client *client, const struct body *body, size_t portion,
	struct ecostream_error *error)
{
	enum ecostream_code code = ecostream_client_begin(client, error);
	for (size_t at = 0; at < body->size && !code; at += portion)
		code = ecostream_client_feed(client, body->bytes + at, at + portion < body->size ? portion
			: body->size - at, error);
	return code ? code : ecostream_client_end(client, error);
}

static struct ecostream_client *client_with(const struct body *body)
{
	struct ecostream_error error = { 0 };
	struct ecostream_client *client;
	assert_ok(ecostream_client_new(&client, &error), error);
	assert_ok(feed(client, body, 777, &error), error);
	return client;
}

static struct ecostream_picture *picture_of(const struct ecostream_client *client,
	const struct ecostream_request *request)
{
	struct ecostream_error error = { 0 };
	struct ecostream_picture *picture;
	assert_ok(ecostream_picture_make(&picture, client, request, &error), error);
	return picture;
}

UNIT_TEST(a_pack_says_what_is_in_it)
{
	struct ecostream_pack_info info;
	ecostream_pack_info(pack, &info);
	assert_int_equal(info.plants, 4 * SAMPLE_PLANTS);
	assert_int_equal(info.kinds, 2);
	assert_true(info.lists > 2 && *info.name && info.low[0] < info.high[0] && info.low[2] < info.high[2]);
}

static void check_geometry(const struct ecostream_picture *picture, uint32_t draw,
	const struct ecostream_draw *info)
{
	static const uint32_t floats[] = { 3, 6, 9, 3, 3, 9 };
	struct ecostream_error error = { 0 };
	struct ecostream_geometry geometry;
	assert_ok(ecostream_picture_geometry(picture, draw, &geometry, &error), error);
	assert_int_equal(geometry.primitives, info->primitives);
	for (size_t i = 0; i < (size_t)geometry.primitives * floats[info->kind]; i++)
		assert_true(isfinite(geometry.position[i]) && fabsf(geometry.position[i]) < 1e5f);
	bool sized = info->kind <= ECOSTREAM_LINES || info->kind == ECOSTREAM_IMPOSTORS;
	assert_true((geometry.size != NULL) == sized);
	for (uint32_t i = 0; i < geometry.primitives && sized; i++)
		assert_true(geometry.size[i] >= 0 && geometry.size[i] < 1e3f);
	bool plain = info->kind == ECOSTREAM_GROUND || info->kind == ECOSTREAM_IMPOSTORS;
	assert_true((geometry.rgb == NULL) == plain);
	ecostream_geometry_free(&geometry);
	assert_null(geometry.position);
}

static void check_places(const struct ecostream_picture *picture, uint32_t draw,
	const struct ecostream_draw *info)
{
	struct ecostream_place *places = calloc(info->places + 1u, sizeof *places);
	ecostream_picture_places(picture, draw, places);
	for (uint32_t i = 0; i < info->places; i++)
		assert_true(fabs(hypot(places[i].sine, places[i].cosine) - 1) < 1e-9 && places[i].scale > 0);
	free(places);
}

UNIT_TEST(what_was_planned_is_what_is_drawn)
{
	struct ecostream_request request = request_of(50000);
	struct ecostream_counts counts;
	struct body body = body_of(&request, &counts);
	struct ecostream_client *client = client_with(&body);
	struct ecostream_picture *picture = picture_of(client, &request);
	uint64_t vertices = 0;
	uint32_t kinds = 0, named = 0;
	for (uint32_t i = 0; i < ecostream_picture_draws(picture); i++) {
		struct ecostream_draw info;
		ecostream_picture_draw(picture, i, &info);
		vertices += info.vertices;
		kinds |= 1u << info.kind;
		named += info.plant[0] != 0;
		check_geometry(picture, i, &info);
		check_places(picture, i, &info);
	}
	assert_int_equal(vertices, counts.vertices);
	assert_true(kinds & 1u << ECOSTREAM_GROUND && kinds & 1u << ECOSTREAM_TRIANGLES && named > 0);
	ecostream_picture_free(picture);
	ecostream_client_free(client);
	free(body.bytes);
}

UNIT_TEST(what_a_client_holds_is_not_sent_again)
{
	struct ecostream_request request = request_of(50000);
	struct ecostream_error error = { 0 };
	struct ecostream_counts first, again;
	struct body body = body_of(&request, &first);
	struct ecostream_client *client = client_with(&body);
	void *holdings;
	free(body.bytes);
	assert_ok(ecostream_client_holdings(client, &holdings, &request.holdings_size, &error), error);
	request.holdings = holdings;
	body = body_of(&request, &again);
	assert_int_equal(again.chunks, 0);
	assert_int_equal(again.vertices, first.vertices);
	assert_true(again.bytes < first.bytes / 4);
	assert_ok(feed(client, &body, 1, &error), error);
	ecostream_picture_free(picture_of(client, &request));
	ecostream_client_free(client);
	free(holdings);
	free(body.bytes);
}

static void assert_says(const struct ecostream_error *error, enum ecostream_code code, const char *text)
{
	assert_int_equal(error->code, code);
	if (!strstr(error->text, text))
		fail_msg("not \"%s\" in: %s", text, error->text);
}

static int refuse(void *context, const void *bytes, size_t size) { return 1; }

UNIT_TEST(impossible_requests_are_refused_and_say_why)
{
	struct ecostream_error none = { 0 }, view = { 0 }, held = { 0 }, tight = { 0 }, write = { 0 };
	struct ecostream_request request = request_of(1000);
	struct ecostream_pack *missing = pack;
	struct ecostream_answer *answer;
	ecostream_pack_open(&missing, "build/tmp/no-such.eco", &none);
	assert_says(&none, ECOSTREAM_NOT_FOUND, "no-such.eco");
	assert_null(missing);
	request.fov_y_deg = 180;
	assert_int_equal(ecostream_plan(&answer, pack, &request, &view), ECOSTREAM_BAD_INPUT);
	assert_says(&view, ECOSTREAM_BAD_INPUT, "fov_y_deg");
	assert_null(answer);
	request = request_of(1000);
	request.holdings = "not holdings";
	request.holdings_size = 12;
	assert_int_not_equal(ecostream_plan(&answer, pack, &request, &held), ECOSTREAM_OK);
	assert_true(held.code && held.text[0]);
	request = request_of(1000);
	request.bytes = 10;
	struct ecostream_counts counts;
	answer = answer_to(&request, &counts);
	assert_int_equal(counts.bytes, 0);
	ecostream_encode(answer, refuse, NULL, &tight);
	assert_says(&tight, ECOSTREAM_BAD_INPUT, "not even the smallest stream fits 10 bytes");
	ecostream_answer_free(answer);
	request.bytes = 0;
	answer = answer_to(&request, &counts);
	assert_int_equal(ecostream_encode(answer, refuse, NULL, &write), ECOSTREAM_IO);
	ecostream_answer_free(answer);
}

UNIT_TEST(streams_that_are_not_whole_are_named_and_what_came_is_kept)
{
	struct ecostream_request request = request_of(50000);
	struct ecostream_error error = { 0 }, early = { 0 }, cut = { 0 }, bad = { 0 }, empty = { 0 };
	struct ecostream_counts counts;
	struct body body = body_of(&request, &counts);
	struct ecostream_client *client;
	struct ecostream_picture *picture;
	assert_ok(ecostream_client_new(&client, &error), error);
	assert_int_equal(ecostream_client_feed(client, body.bytes, 1, &early), ECOSTREAM_BAD_USAGE);
	assert_int_equal(ecostream_picture_make(&picture, client, &request, &empty), ECOSTREAM_NOT_FOUND);
	body.size--;
	assert_int_equal(feed(client, &body, 4096, &cut), ECOSTREAM_DAMAGED);
	ecostream_picture_free(picture_of(client, &request));
	body.bytes[body.size / 2] ^= 1;
	ecostream_client_free(client);
	assert_ok(ecostream_client_new(&client, &error), error);
	assert_int_equal(feed(client, &body, 4096, &bad), ECOSTREAM_DAMAGED);
	assert_true(bad.text[0]);
	ecostream_client_free(client);
	free(body.bytes);
}

/* ---- Impostors ---- */

/* Every tree of the scene as its impostor, as a stream. */
static struct body impostors_of(struct scene_builder *scene, const struct eco_view *view)
{
	struct eco_plan plan;
	struct eco_writer w;
	scene_make(scene, NULL, 0);
	scene_make_impostor(scene, 1500);
	scene_plan(scene, view, 1, &plan);
	plan.cuts[0] = scene_rule(A_TREE, L_IMPOSTOR, 0, 1, 1, 0, ECO_BANDS);
	plan.cut_count = 1;
	plan.vertices = plan_twin_vertices(&scene->scene, &plan, view, &plan.visible_plants);
	scene_stream(scene, &plan, NULL, &w);
	eco_plan_free(&plan);
	return (struct body){ w.bytes, w.size, w.size };
}

/* Rays from the south: over a square of twice the plant's ball some meet it, and none at its rim. */
static void check_looks(const struct ecostream_picture *picture, const struct ecostream_geometry *ball)
{
	enum { SIDE = 41 };
	const float far = 20 * *ball->size, eye[3] = { ball->position[0], ball->position[1] - far,
		ball->position[2] };
	float rays[3 * SIDE], along[SIDE];
	uint8_t rgb[3 * SIDE];
	uint32_t met = 0;
	for (int row = 0; row < SIDE; row++) {
		memset(rgb, 77, sizeof rgb);
		for (int i = 0; i < SIDE; i++) {
			rays[3 * i] = (float)(i - SIDE / 2) / (SIDE / 2) * 2 * *ball->size;
			rays[3 * i + 1] = far;
			rays[3 * i + 2] = (float)(row - SIDE / 2) / (SIDE / 2) * 2 * *ball->size;
		}
		ecostream_picture_look(picture, 0, eye, rays, SIDE, along, rgb);
		for (int i = 0; i < SIDE; i++) {
			bool hit = isfinite(along[i]), rim = hypotf(rays[3 * i],
				rays[3 * i + 2]) > 1.2f * *ball->size;
			assert_true(hit ? !rim && fabsf(along[i] - 1) < 0.06f : rgb[3 * i] == 77);
			met += hit;
		}
	}
	assert_true(met > 30);
}

UNIT_TEST(impostors_are_looked_at_along_rays)
{
	struct eco_view view = scene_view();
	struct ecostream_request request = { .fov_y_deg = view.fov_y_deg, .width = view.width,
		.height = view.height };
	memcpy(request.eye, view.eye, sizeof request.eye);
	memcpy(request.target, view.target, sizeof request.target);
	memcpy(request.up, view.up, sizeof request.up);
	struct scene_builder scene;
	struct ecostream_error error = { 0 };
	struct ecostream_geometry ball;
	struct ecostream_draw info;
	struct body body = impostors_of(&scene, &view);
	struct ecostream_client *client = client_with(&body);
	struct ecostream_picture *picture = picture_of(client, &request);
	assert_int_equal(ecostream_picture_draws(picture), 1);
	ecostream_picture_draw(picture, 0, &info);
	assert_true(info.kind == ECOSTREAM_IMPOSTORS && info.primitives == 1 && info.places > 0
		&& info.vertices == info.places && info.plant[0]);
	check_geometry(picture, 0, &info);
	assert_ok(ecostream_picture_geometry(picture, 0, &ball, &error), error);
	check_looks(picture, &ball);
	ecostream_geometry_free(&ball);
	ecostream_picture_free(picture);
	ecostream_client_free(client);
	scene_free(&scene);
	free(body.bytes);
}

UNIT_MAIN(open_pack, close_pack)
