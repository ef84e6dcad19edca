/* Random views and budgets against a real pack, through everything but the socket: plan, stream, parse, decode, select. And damage:
 * flipped bits and cut ends of the pack and of a stream.
 *
 *   requests PACK REQUESTS DAMAGES [SEED]
 *
 * Counts violations (more vertices or bytes than asked for, other vertices drawn than planned, a chunk sent twice), differing answers to
 * the same request, and damages that went unnoticed with another result. Prints the counts; exit 1 if one of them is not 0. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "client-min/view_select.h"
#include "server/store.h"
#include "server/stream.h"

static uint64_t state;

static uint64_t bits(void)
{
	uint64_t z = state += 0x9E3779B97F4A7C15u;
	z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
	z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
	return z ^ (z >> 31);
}

static double real(double low, double high)
{
	return low + (high - low) * (double)(bits() >> 11) / 9007199254740992.0;
}

static void stop(const char *what, const struct eco_error *error)
{
	fprintf(stderr, "requests: %s: %s\n", what, error->text);
	exit(1);
}

/* Near and far, from inside the plants to high above; budgets from 0 to 10^8, each power of ten as likely. */
static struct eco_request random_request(const struct eco_scene *scene)
{
	const struct eco_tile *root = &scene->tiles[scene->root];
	static const uint32_t sizes[] = { 1, 64, 320, 800, 1600 };
	struct eco_request r = { .bytes = ECO_BYTES_UNBOUNDED };
	double reach = pow(10, real(-1, 1.5));
	for (int i = 0; i < 3; i++) {
		double middle = (root->low[i] + root->high[i]) / 2, half = (root->high[i] - root->low[i]) / 2 + 1e-3;
		r.view.target[i] = middle + half * real(-1, 1);
		r.view.eye[i] = r.view.target[i] + half * reach * real(-1, 1);
		r.view.up[i] = i == 2;
	}
	r.view.fov_y_deg = real(0.5, 150);
	r.view.width = sizes[bits() % 5];
	r.view.height = sizes[bits() % 5];
	r.vertices = bits() % 20 == 0 ? bits() % 4 : (uint64_t)pow(10, real(0, 8));
	if (bits() % 4 == 0)
		r.bytes = (uint64_t)pow(10, real(1, 7));
	return r;
}

struct counts { uint64_t vertices, bytes, drawn, twice, differ, empty, ended; };

static uint64_t body_hash(const struct srv_body *body)
{
	XXH3_state_t *hash = XXH3_createState();
	XXH3_64bits_reset(hash);
	for (uint32_t i = 0; i < body->piece_count; i++)
		XXH3_64bits_update(hash, body->pieces[i].bytes, body->pieces[i].size);
	uint64_t h = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
	return h;
}

/* The body of the answer; fits false: 204. */
static bool answer(const struct srv_scene *scene, const struct eco_request *request, const struct eco_holdings *holdings,
	struct srv_body *body)
{
	struct srv_stream stream;
	struct eco_error error = { 0 };
	*body = (struct srv_body){ 0 };
	if (srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene, .request = request, .holdings = holdings }, &error))
		stop("planning", &error);
	bool fits = stream.fits;
	if (fits && srv_stream_write(&stream, body, &error))
		stop("writing", &error);
	srv_stream_free(&stream);
	return fits;
}

static void receive(struct view_store *store, const struct srv_body *body)
{
	struct eco_wire_parser *parser;
	struct eco_error error = { 0 };
	view_store_begin(store);
	if (eco_wire_parser_new(&parser, &view_store_events, store, &error))
		stop("parser", &error);
	for (uint32_t i = 0; i < body->piece_count; i++)
		if (eco_wire_feed(parser, body->pieces[i].bytes, body->pieces[i].size, &error))
			stop("stream", &error);
	if (eco_wire_finish(parser, &error))
		stop("stream", &error);
	eco_wire_parser_free(parser);
}

static void one_request(const struct srv_scene *scene, struct view_store *store, struct counts *counts, bool twice)
{
	struct eco_request request = random_request(&scene->pack->scene);
	struct eco_holdings holdings;
	struct eco_error error = { 0 };
	struct srv_body body, again;
	if (eco_view_check(&request.view, NULL))
		return;
	if (view_store_holdings(store, &holdings, &error))
		stop("holdings", &error);
	bool fits = answer(scene, &request, &holdings, &body);
	if (twice) {
		bool also = answer(scene, &request, &holdings, &again);
		counts->differ += also != fits || (fits && body_hash(&body) != body_hash(&again));
		srv_body_free(&again);
	}
	free(holdings.items);
	counts->empty += !fits;
	if (fits) {
		struct lod_eye eye;
		struct view_selection selection;
		receive(store, &body);
		lod_eye_make(&eye, &request.view);
		if (view_select_make(&selection, store, &eye, &error))
			stop("selection", &error);
		counts->vertices += selection.vertices > request.vertices;
		counts->bytes += body.size_bytes > request.bytes;
		counts->drawn += selection.vertices != view_store_plan(store)->vertices;
		view_select_free(&selection);
	}
	srv_body_free(&body);
}

/* ---- Damage ---- */

static uint8_t *flatten(const struct srv_body *body)
{
	uint8_t *all = malloc(body->size_bytes + 1), *at = all;
	for (uint32_t i = 0; i < body->piece_count; at += body->pieces[i++].size)
		memcpy(at, body->pieces[i].bytes, body->pieces[i].size);
	return all;
}

/* Parses without decoding: every frame's hash, fields and order. True if the whole was accepted. */
static bool stream_accepted(const uint8_t *bytes, size_t size)
{
	static const struct eco_wire_events nothing;
	struct eco_wire_parser *parser;
	struct eco_error error = { 0 };
	if (eco_wire_parser_new(&parser, &nothing, NULL, &error))
		stop("parser", &error);
	bool ok = !eco_wire_feed(parser, bytes, size, &error) && !eco_wire_finish(parser, &error);
	eco_wire_parser_free(parser);
	return ok;
}

static uint64_t damage_stream(const struct srv_scene *scene, long damages)
{
	struct eco_request request;
	struct srv_body body;
	uint64_t unnoticed = 0;
	do {
		request = random_request(&scene->pack->scene);
		request.vertices = 2000;
		request.bytes = ECO_BYTES_UNBOUNDED;
	} while (eco_view_check(&request.view, NULL) || !answer(scene, &request, NULL, &body));
	uint8_t *bytes = flatten(&body);
	if (!stream_accepted(bytes, body.size_bytes))
		stop("stream", &(struct eco_error){ .text = "the undamaged stream is refused" });
	for (long i = 0; i < damages; i++) {
		uint64_t at = bits() % body.size_bytes;
		uint8_t flip = (uint8_t)(1u << (bits() % 8));
		if (i % 4 == 3) {
			unnoticed += stream_accepted(bytes, at);
			continue;
		}
		bytes[at] ^= flip;
		unnoticed += stream_accepted(bytes, body.size_bytes);
		bytes[at] ^= flip;
	}
	free(bytes);
	srv_body_free(&body);
	return unnoticed;
}

static uint64_t file_size(FILE *f)
{
	fseek(f, 0, SEEK_END);
	long size = ftell(f);
	rewind(f);
	return size > 0 ? (uint64_t)size : 0;
}

/* A pack is noticed to be damaged when it is opened or, inside a chunk, when that chunk is read. */
static bool pack_accepted(const uint8_t *bytes, size_t size, uint64_t at)
{
	struct eco_pack *pack;
	struct eco_error error = { 0 };
	bool ok = true;
	if (eco_pack_open_memory(&pack, bytes, size, &error))
		return false;
	for (uint32_t i = 0; i < pack->scene.chunk_count && ok; i++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[i];
		const uint8_t *payload;
		size_t payload_bytes;
		/* only what the damage can have touched: reading every chunk 10^5 times would take hours */
		if (at >= chunk->offset && at < chunk->offset + chunk->size_bytes)
			ok = !eco_pack_payload(pack, i, &payload, &payload_bytes, &error);
	}
	eco_pack_close(pack);
	return ok;
}

static uint64_t damage_pack(const char *path, long damages)
{
	FILE *f = fopen(path, "rb");
	uint64_t unnoticed = 0, size = f ? file_size(f) : 0;
	uint8_t *bytes = malloc(size + 1);
	if (!f || !bytes || fread(bytes, 1, size, f) != size)
		stop(path, &(struct eco_error){ .text = "cannot be read" });
	fclose(f);
	if (!pack_accepted(bytes, size, 0))
		stop(path, &(struct eco_error){ .text = "the undamaged pack is refused" });
	for (long i = 0; i < damages; i++) {
		/* half of them in the tables, which are small beside the chunks */
		uint64_t at = bits() % (i % 2 && size > 65536 ? 65536 : size);
		if (i % 8 == 7) {
			unnoticed += pack_accepted(bytes, at, at);
			continue;
		}
		uint8_t flip = (uint8_t)(1u << (bits() % 8));
		bytes[at] ^= flip;
		unnoticed += pack_accepted(bytes, size, at);
		bytes[at] ^= flip;
	}
	free(bytes);
	return unnoticed;
}

int main(int argc, char **argv)
{
	struct srv_store scenes;
	struct view_store *store = NULL;
	struct eco_error error = { 0 };
	struct counts counts = { 0 };
	if (argc < 4 || argc > 5) {
		fprintf(stderr, "usage: requests PACK REQUESTS DAMAGES [SEED]\n");
		return 2;
	}
	long requests = atol(argv[2]), damages = atol(argv[3]);
	state = argc == 5 ? strtoull(argv[4], NULL, 10) : 1;
	srv_store_init(&scenes);
	if (srv_store_add(&scenes, "scene", argv[1], &error))
		stop(argv[1], &error);
	for (long i = 0; i < requests; i++) {
		if (i % 500 == 0) {      /* a new client now and then, so that both full and empty hands are tried */
			if (store)
				counts.twice += view_store_stats(store)->chunks_twice;
			view_store_free(store);
			if (view_store_new(&store, &(struct view_store_options){ 0 }, &error))
				stop("store", &error);
		}
		one_request(&scenes.scenes[0], store, &counts, i % 10 == 0);
	}
	view_store_free(store);
	uint64_t stream = damages ? damage_stream(&scenes.scenes[0], damages) : 0, file = damages ? damage_pack(argv[1], damages) : 0;
	printf("%ld requests: %llu over the vertex budget, %llu over the byte budget, %llu drawn otherwise than planned, %llu chunks sent "
		"twice, %llu answers that differ (%llu too small for any picture)\n", requests, (unsigned long long)counts.vertices,
		(unsigned long long)counts.bytes, (unsigned long long)counts.drawn, (unsigned long long)counts.twice,
		(unsigned long long)counts.differ, (unsigned long long)counts.empty);
	printf("%ld damages of a stream: %llu unnoticed; %ld of the pack: %llu unnoticed\n", damages, (unsigned long long)stream, damages,
		(unsigned long long)file);
	srv_store_free(&scenes);
	return counts.vertices || counts.bytes || counts.drawn || counts.twice || counts.differ || stream || file;
}
